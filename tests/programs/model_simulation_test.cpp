#include <catch2/catch.hpp>

#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <busbar/core/log.hpp>
#include <busbar/product/controller.hpp>

#include "product/machine/simulated_runtime.hpp"
#include "programs/model_simulation.hpp"
#include "simulation/environment.hpp"
#include "support/effort.hpp"

namespace model_simulation_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::size_t all_sequences = 500;
constexpr std::size_t sequences_of_round = 2;
constexpr std::size_t steps_of_sequence = 20;

/// Holds the thread that makes another generation once it has loaded a project's models. Any
/// thread.
class HeldLoads final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view text) override
    {
        std::unique_lock lock{mutex_};
        if (text.ends_with("information models were loaded")) {
            ++loads_;
            changed_.notify_all();
            changed_.wait(lock, [&] { return !is_holding_; });
        }
    }
    void wait_for_load()
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return loads_ != 0; });
    }
    void let_go()
    {
        const std::lock_guard lock{mutex_};
        is_holding_ = false;
        changed_.notify_all();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int loads_{0};
    bool is_holding_{true};
};

/// A controller that makes another generation, with the project 2, as long as loads are held.
struct Restarting {
    Restarting()
    {
        REQUIRE(controller);
        serving = std::thread{[this] { CHECK((*controller)->run()); }};
        REQUIRE(chief.project("write", project(2)) == Outcome::Done);
        REQUIRE(chief.restart() == Outcome::Done);
        log.wait_for_load();
    }
    Restarting(const Restarting&) = delete;
    Restarting& operator=(const Restarting&) = delete;
    ~Restarting()
    {
        chief.disconnect();
        log.let_go();
        (*controller)->stop();
        serving.join();
    }
    [[nodiscard]] std::string project(int number) const
    {
        return simulated_project(number, site.ports.front(), "Speed");
    }
    /// Once the other generation serves.
    [[nodiscard]] ControllerAdministrator::ProjectReport report()
    {
        for (;;) {
            const auto report =
                chief.project_report("nsu=" + std::string{simulated_model} + ";s=Number");
            if (report && report->number) {
                return *report;
            }
        }
    }

    harness::Chance chance{1, 3};
    ControllerSite site{chance, true};
    HeldLoads log;
    product::SimulatedRuntime runtime;
    Configured<std::unique_ptr<product::Controller>> controller = product::Controller::create(
        {.file = site.file, .project = (site.folder.path / "project").string()}, runtime,
        {.log = &log, .takes_signals = false, .greets = false});
    ControllerAdministrator chief{site.ports, (site.folder.path / "client").string(),
                                  ControllerSite::password};
    std::thread serving;
};

} // namespace

TEST_CASE("9.13 a project that is written while a restart is made ready counts from that on",
          "[9.13]")
{
    Restarting restarting;
    REQUIRE(restarting.chief.project("write", restarting.project(3)) == Outcome::Done);
    restarting.log.let_go();
    const auto report = restarting.report();
    CHECK(report.number == 3);
    CHECK(report.state == "in use");
    CHECK(report.document == restarting.project(3));
}

TEST_CASE("no certificate is made while its names may be about to change")
{
    Restarting restarting;
    CHECK(restarting.chief.forget_own_certificate() == Outcome::Refused);
    CHECK(restarting.chief.why_not() == "DeleteCertificate Bad_InvalidState");
    restarting.log.let_go();
    static_cast<void>(restarting.report());
    CHECK(restarting.chief.forget_own_certificate() == Outcome::Done);
}

// The environment says the same as for the other simulation, see controller_simulation_test.cpp.
TEST_CASE("a controller of model mode serves a project that was acknowledged, and always starts")
{
    const std::size_t part = part_of_round("model_simulation", all_sequences / sequences_of_round);
    const std::uint64_t first =
        number_from("BUSBAR_SIMULATION_SEED", is_full_effort() ? 1 : 1 + part * sequences_of_round);
    const std::uint64_t count = number_from("BUSBAR_SIMULATION_SEQUENCES",
                                            is_full_effort() ? all_sequences : sequences_of_round);
    ModelSimulation::Counts counts;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        ModelSimulation simulation{seed};
        simulation.run(steps_of_sequence);
        if (!simulation.violations().empty()) {
            std::fprintf(stderr, "seed %llu\n%s\n", static_cast<unsigned long long>(seed),
                         simulation.story().c_str());
        }
        CAPTURE(seed);
        REQUIRE(simulation.violations() == std::vector<std::string>{});
        counts.written += simulation.counts().written;
        counts.updated += simulation.counts().updated;
        counts.refused += simulation.counts().refused;
        counts.unknown += simulation.counts().unknown;
        counts.starts += simulation.counts().starts;
    }
    // What is to be seen was there to be seen.
    CAPTURE(first, count);
    CHECK(counts.starts > 4 * count);
    CHECK(counts.written > 0);
    if (count >= 10 * sequences_of_round) {
        CHECK(counts.updated > count);
        CHECK(counts.refused > count);
        CHECK(counts.unknown > 0);
    }
}

} // namespace model_simulation_test
