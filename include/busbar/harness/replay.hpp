#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/world.hpp>

namespace busbar::harness {

/// Plays one side of a recorded connection against an engine, at the recorded times, and compares
/// the engine's answers with the recording.
///
/// Sessions without security are the same byte for byte, in a world with the recording's seed and
/// the same actors. The weather must have one fixed latency. One thread; the world must outlive it.
class BUSBAR_API Replay final : public Acceptor, private LinkEnd {
public:
    /// Sends the bytes of `played`, and expects what the other side sent.
    Replay(World& world, const Recording& recording, Side played, std::uint32_t connection = 1);
    ~Replay() override;

    /// Plays the client: connects at the recorded time, or now if that has passed, and runs the
    /// world until the played side has ended and everything on its way has arrived. Errors are
    /// those of Network::connect().
    Result<void> run(std::string_view url);
    /// Plays the server: a client has connected. Call Network::listen() with this object to make
    /// that possible.
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;
    /// True if everything has been sent, and as much has arrived as was recorded.
    [[nodiscard]] bool is_over() const;

    /// Empty if everything that has arrived so far equals the recording. Otherwise the first byte
    /// that differs, the message that contains it, and the seeds if the world has another one than
    /// the recording. compare_messages() says which values differ.
    [[nodiscard]] std::string difference() const;

private:
    // LinkEnd.
    [[nodiscard]] std::span<const std::byte> output() const override { return {}; }
    void consume(std::size_t) override {}
    void feed(std::span<const std::byte> in) override;
    void link_lost() override { link_.reset(); }

    void begin(std::shared_ptr<Link> link);
    void send_due();
    [[nodiscard]] std::string first_difference() const;
    [[nodiscard]] TimePoint time_of(const Recording::Entry& entry) const;

    World& world_;
    std::uint64_t seed_;
    Side played_;
    std::vector<Recording::Entry> entries_;
    std::vector<std::byte> expected_;
    std::vector<std::byte> came_;
    TimePoint opened_{};
    Duration shift_{0};
    std::size_t next_{0};
    std::shared_ptr<Link> link_;
    Alarm sending_;
};

} // namespace busbar::harness
