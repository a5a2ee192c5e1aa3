#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "attacker.hpp"
#include "library_client.hpp"
#include "memory_weather.hpp"
#include "subscriber.hpp"

namespace busbar::test {

struct SimulationOptions {
    std::uint64_t seed{1};
    std::size_t clients{50};
    /// One in so many of them is an attacker; 0: none.
    std::size_t attackers_one_in{8};
    /// Of the library, beside those.
    std::size_t library_clients{2};
};

/// One server, its plant and its clients on a bad network, in virtual time. The same options make
/// the same things happen, in every process.
class Simulation {
public:
    explicit Simulation(const SimulationOptions& options);

    /// All clients come, and things happen for so long.
    void run(std::chrono::minutes time);
    /// Everything becomes quiet and good; when what was lost has been made good, all has to have
    /// arrived. Then the clients leave, and the server has to forget them.
    void finish();

    [[nodiscard]] const Trace& trace() const { return trace_; }
    /// Bytes of the heap that are in use; 0 where nobody counts them.
    [[nodiscard]] static std::size_t heap_in_use();

private:
    [[nodiscard]] static server::ServerConfig config();
    [[nodiscard]] harness::ServerParts server_parts();
    void jump();
    void check_counts();
    void check_empty();

    World world_;
    Scheduler& scheduler_{world_.scheduler()};
    Weather& weather_{world_.network().weather()};
    Trace trace_{scheduler_};
    NullLog log_;
    PlainUsers users_;
    Chance chance_;
    MemoryWeather memory_;
    Plant plant_;
    ServerHost host_;
    std::vector<std::unique_ptr<Subscriber>> clients_;
    std::vector<std::unique_ptr<LibraryClient>> library_clients_;
    std::vector<std::unique_ptr<Attacker>> attackers_;
    Alarm jump_;
};

} // namespace busbar::test
