#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include <busbar/core/clock.hpp>

#include "chance.hpp"
#include "scheduler.hpp"

namespace busbar::test {

/// An engine at one end of a link.
class LinkEnd {
public:
    LinkEnd() = default;
    LinkEnd(const LinkEnd&) = delete;
    LinkEnd& operator=(const LinkEnd&) = delete;
    virtual ~LinkEnd() = default;

    [[nodiscard]] virtual std::span<const std::byte> output() const = 0;
    virtual void consume(std::size_t size) = 0;
    virtual void feed(std::span<const std::byte> in) = 0;
    /// The link has ended; it knows this end no more.
    virtual void link_lost() = 0;
};

/// What a network does to its connections. Shared by all links and may be changed at any time.
struct Weather {
    Duration min_latency{std::chrono::milliseconds{1}};
    Duration max_latency{std::chrono::milliseconds{150}};
    /// Of so many bursts of bytes one is held up, and by how much.
    std::size_t stall_one_in{200};
    Duration max_stall{std::chrono::seconds{20}};
    /// How long connections live before they are reset, on average.
    Duration mean_life{std::chrono::minutes{40}};
    /// How long an end may go on without learning that it is alone.
    Duration max_notice{std::chrono::seconds{120}};
    bool has_resets{true};
};

/// A connection as TCP makes it: bytes arrive in order, at some time, in any pieces, and are not
/// lost as long as it lives. A reset takes all that is under way with it.
class SimulatedLink : public std::enable_shared_from_this<SimulatedLink> {
public:
    enum Side : std::size_t { Client, Server };

    SimulatedLink(Scheduler& scheduler, const Weather& weather, Chance chance);

    /// The end must stay until link_lost(), leave() or close(). With both ends the link's life,
    /// and its death, is under way.
    void attach(Side side, LinkEnd& end);
    /// Sends what waits in the end's output.
    void flush(Side side);
    /// The end goes without a word. The other one learns of it later, if ever.
    void leave(Side side);
    /// The end goes after the last byte of its output has arrived.
    void close(Side side);

private:
    struct Direction {
        std::deque<std::vector<std::byte>> pieces;
        TimePoint last_arrival{};
    };

    void send(Side from, std::span<const std::byte> bytes);
    void arrive(Side from);
    void reset();
    void tell(Side side, Duration delay);

    Scheduler* scheduler_;
    const Weather* weather_;
    Chance chance_;
    std::array<LinkEnd*, 2> ends_{};
    /// By the side that sends.
    std::array<Direction, 2> directions_;
    bool is_cut_{false};
};

} // namespace busbar::test
