#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/world.hpp>

namespace busbar::harness {

/// Plays one side of a recorded connection against an engine, at the recorded times, and compares
/// what the engine answers with what was recorded.
///
/// Byte for byte the same are sessions without security, in a world with the recording's seed and
/// the same actors. The weather must have one latency. One thread; the world must outlive it.
class BUSBAR_API Replay final : public Acceptor, private LinkEnd {
public:
    /// The bytes of `played` are sent; what the other side sent is what has to come.
    Replay(World& world, const Recording& recording, Side played, std::uint32_t connection = 1);
    ~Replay() override;

    /// Client: connects at the recorded time, or now if that is over, and runs the world until the
    /// side that is played has ended and what was under way has arrived. What
    /// Network::connect() says.
    Result<void> run(std::string_view url);
    /// Server: a client has connected. Network::listen() with this makes it possible.
    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;
    /// Whether all has been sent and as much as was recorded has come.
    [[nodiscard]] bool is_over() const;

    /// Empty if what came is what was recorded, so far as it has come. Else the first byte that
    /// differs, and in which message it stands.
    [[nodiscard]] std::string difference() const;

private:
    // LinkEnd
    [[nodiscard]] std::span<const std::byte> output() const override { return {}; }
    void consume(std::size_t) override {}
    void feed(std::span<const std::byte> in) override;
    void link_lost() override { link_.reset(); }

    void begin(std::shared_ptr<Link> link);
    void send_due();
    [[nodiscard]] TimePoint time_of(const Recording::Entry& entry) const;

    World& world_;
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
