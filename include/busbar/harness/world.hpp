#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/harness/jumping_clock.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/harness/network.hpp>
#include <busbar/harness/scheduler.hpp>

namespace busbar::harness {

/// The users of a world's randomness.
enum class Actor : std::uint8_t { Server, Client, Other };

/// Servers, clients and the network between them, in virtual time: a day takes seconds, and the
/// same seed makes the same things happen. Nothing in it reads a clock, sleeps or opens a port.
///
/// For threads and real peers there is RealWorld (busbar/harness_net/real_world.hpp). One thread;
/// everything that lives in a world must be destroyed before it.
class BUSBAR_API World {
public:
    explicit World(std::uint64_t seed = seed_from_environment(), DateTime begin = first_day);
    /// If there are faults that have never acted, the running test fails, unless the network
    /// forgives it or an exception is on its way: see set_fail_test() in report.hpp.
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// The number in the environment's BUSBAR_SEED; 1 if there is none.
    [[nodiscard]] static std::uint64_t seed_from_environment();
    /// Show it when a test fails: BUSBAR_SEED replays it.
    [[nodiscard]] std::uint64_t seed() const { return seed_; }
    /// Returns randomness for the next actor of a kind, numbered by kind: the second client gets
    /// the same in each run, however many servers there are.
    [[nodiscard]] Chance new_chance(Actor kind)
    {
        const auto index = static_cast<std::size_t>(kind);
        return {seed_, (index << 32U) + ++actors_.at(index)};
    }

    [[nodiscard]] TimePoint now() const { return scheduler_.now(); }
    /// Lets virtual time pass.
    void run_for(Duration time) { scheduler_.run_for(time); }
    /// Lets virtual time pass up to `end`.
    void run_until(TimePoint end) { scheduler_.run_until(end); }
    /// Runs until `condition`, called after each thing that happens, holds, or the time is over.
    /// Returns whether it holds.
    [[nodiscard]] bool run_until(FunctionRef<bool()> condition,
                                 Duration limit = std::chrono::minutes{1})
    {
        return scheduler_.run_until(condition, now() + limit);
    }
    /// Lets one thing happen; false if there is nothing left.
    bool step() { return scheduler_.step(); }
    /// Sets the time of day, forwards or back; monotonic time goes on.
    void jump_clock(Duration by) { clock_.jump(by); }

    [[nodiscard]] Scheduler& scheduler() { return scheduler_; }
    [[nodiscard]] const WallClock& clock() const { return clock_; }
    [[nodiscard]] Network& network() { return network_; }
    /// The log of all its servers and clients.
    [[nodiscard]] LogBook& log() { return log_; }
    /// Returns a log for one of them, whose lines begin with "client", the next one's with
    /// "client 2". Lives as long as the world.
    [[nodiscard]] LogSink& new_log(Actor kind);
    /// The same with a name that the test gives.
    [[nodiscard]] LogSink& new_log(std::string name);
    /// The last messages on its network; see Network::trace().
    [[nodiscard]] std::string trace(std::size_t lines = 20) const { return network_.trace(lines); }
    /// Returns the seed, the last lines of the log and the last messages: a test that fails shows
    /// them.
    [[nodiscard]] std::string account(std::size_t lines = 20) const;

private:
    std::uint64_t seed_;
    std::array<std::uint64_t, 3> actors_{};
    std::array<std::size_t, 3> speakers_{};
    Scheduler scheduler_;
    JumpingClock clock_;
    LogBook log_{scheduler_};
    std::vector<std::unique_ptr<Speaker>> logs_;
    Network network_{scheduler_, clock_, seed_, &log_};
};

} // namespace busbar::harness
