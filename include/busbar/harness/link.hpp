#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/harness/chance.hpp>
#include <busbar/harness/scheduler.hpp>

namespace busbar::harness {

/// The ends of a link.
enum class Side : std::uint8_t { Client, Server };

/// Returns the opposite end.
[[nodiscard]] constexpr Side other(Side side)
{
    return side == Side::Client ? Side::Server : Side::Client;
}

/// An engine at one end of a link.
class BUSBAR_API LinkEnd {
public:
    LinkEnd() = default;
    LinkEnd(const LinkEnd&) = delete;
    LinkEnd& operator=(const LinkEnd&) = delete;
    virtual ~LinkEnd() = default;

    /// Bytes for the other end.
    [[nodiscard]] virtual std::span<const std::byte> output() const = 0;
    /// Removes the first `size` bytes of output(), which were sent.
    virtual void consume(std::size_t size) = 0;
    /// Takes bytes of the other end.
    virtual void feed(std::span<const std::byte> in) = 0;
    /// The link has ended and does not use this end any more.
    virtual void link_lost() = 0;
};

/// The behaviour of a network. Shared by links; may be changed at any time. By default nothing goes
/// wrong.
struct Weather {
    /// The latency of each burst of bytes.
    Duration min_latency{std::chrono::milliseconds{1}};
    Duration max_latency{std::chrono::milliseconds{1}};
    /// Bytes arrive in pieces of at most this size.
    std::size_t max_piece{SIZE_MAX};
    /// Each burst is cut at two random places, and its parts arrive one after the other.
    bool has_random_cuts{false};
    /// One in this many bursts of bytes is delayed, and the maximum delay; 0: none.
    std::size_t stall_one_in{0};
    Duration max_stall{0};
    /// The average life of connections before they are reset, 0: for ever; and whether connections
    /// that have reached their end are reset.
    Duration mean_life{0};
    bool has_resets{true};
    /// The maximum time until an end notices that the other one is gone.
    Duration max_notice{0};
    /// The bytes that each direction carries in a second; 0: any number.
    std::size_t bytes_per_second{0};

    /// Returns what contradicts itself, "min_latency 0.005 s is above max_latency 0.001 s"; empty
    /// if nothing does. A link that is to carry bytes throws std::invalid_argument with it.
    [[nodiscard]] BUSBAR_API std::string flaw() const;
};

class Link;

/// Sees the bytes of an end before they are on their way, and decides about them. Belongs to one
/// link.
class BUSBAR_API LinkFilter {
public:
    LinkFilter() = default;
    LinkFilter(const LinkFilter&) = delete;
    LinkFilter& operator=(const LinkFilter&) = delete;
    virtual ~LinkFilter() = default;

    /// `from` has sent `bytes`; pass those that shall arrive to Link::send().
    virtual void pass(Link& link, Side from, std::span<const std::byte> bytes) = 0;
};

/// Is notified of what happens on links.
class BUSBAR_API LinkObserver {
public:
    LinkObserver() = default;
    LinkObserver(const LinkObserver&) = delete;
    LinkObserver& operator=(const LinkObserver&) = delete;
    virtual ~LinkObserver() = default;

    /// Called for each new link.
    virtual void opened(const Link& link) = 0;
    /// Bytes that `from` has sent arrive at the other end now.
    virtual void arrived(const Link& link, Side from, std::span<const std::byte> bytes) = 0;
    /// `side` is gone, or the link between; the other end, if it still exists, learns of it now.
    virtual void ended(const Link& link, Side side) = 0;
};

/// A connection with the properties of TCP: bytes arrive in order, at some time, in any pieces, and
/// are not lost as long as it lives. A reset discards everything on its way. One thread; scheduler
/// and weather must outlive it. Held by shared pointers: bytes on their way keep it alive.
class BUSBAR_API Link : public std::enable_shared_from_this<Link> {
public:
    Link(Scheduler& scheduler, const Weather& weather, Chance chance);

    /// The end must exist until link_lost(), leave() or close(). With both ends attached the link's
    /// life begins, and with it the time until it ends.
    void attach(Side side, LinkEnd& end);
    /// Sends the bytes that wait in the end's output; nothing before the other end is attached.
    void flush(Side side);
    /// The end leaves without notice. The other one learns of it later, if ever.
    void leave(Side side);
    /// The end leaves after the last byte of its output has arrived.
    void close(Side side);

    // For tests that disturb the link. A link that was cut stays cut.

    /// A reset: nothing arrives any more, and both ends learn of it at once.
    void cut();
    /// Cuts likewise, but only `side` learns of it; the other end may continue to send.
    void cut_for(Side side);
    /// Holds what `from` has sent and sends, its end included, until release().
    void hold(Side from);
    /// Ends hold().
    void release(Side from);
    /// From now on pieces of at most `size` bytes arrive, whatever the weather.
    void split(std::size_t size) { max_piece_ = size; }

    /// Call these before there are ends. Both may be null.
    void set_filter(std::unique_ptr<LinkFilter> filter) { filter_ = std::move(filter); }
    void set_observer(std::shared_ptr<LinkObserver> observer) { observer_ = std::move(observer); }
    /// Puts bytes on their way as if `from` had sent them; they and the following ones arrive
    /// `delay` later than the weather says. For filters.
    void send(Side from, std::span<const std::byte> bytes, Duration delay = {});

    /// The time when the last byte that `from` has sent so far arrives; in the past if it has.
    [[nodiscard]] TimePoint last_arrival(Side from) const
    {
        return ends_[static_cast<std::size_t>(from)].last_arrival;
    }
    [[nodiscard]] bool is_cut() const { return is_cut_; }
    [[nodiscard]] Scheduler& scheduler() const { return *scheduler_; }

private:
    using Piece = std::vector<std::byte>;
    struct End {
        LinkEnd* engine{nullptr};
        bool was_attached{false};
        bool is_gone{false};
        // State of what this end sends:
        std::deque<Piece> pieces;
        TimePoint last_arrival{};
        /// When the last byte has left.
        TimePoint last_departure{};
        bool is_held{false};
        /// Number of pieces that have arrived while held.
        std::size_t due{0};
        /// The end has left while held, after all of them.
        bool is_end_held{false};
    };

    [[nodiscard]] End& end(Side side) { return ends_[static_cast<std::size_t>(side)]; }
    void send_cut(Side from, std::span<const std::byte> bytes, TimePoint time);
    void send_whole(Side from, std::span<const std::byte> bytes, TimePoint time);
    void put(Side from, std::span<const std::byte> piece, TimePoint arrival);
    void arrive(Side from);
    void deliver(Side from);
    void reset();
    /// Draws the length of the link's life once the weather limits it.
    void limit_life();
    /// Tells the other end, after the last piece, that `side` has left.
    void tell_of_end(Side side);
    void tell(Side side, Duration delay);
    void tell_now(Side side);

    Scheduler* scheduler_;
    const Weather* weather_;
    Chance chance_;
    /// Indexed by Side.
    std::array<End, 2> ends_;
    std::unique_ptr<LinkFilter> filter_;
    std::shared_ptr<LinkObserver> observer_;
    std::size_t max_piece_{SIZE_MAX};
    bool is_cut_{false};
    bool has_limited_life_{false};
};

} // namespace busbar::harness
