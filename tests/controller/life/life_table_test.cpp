#include <catch2/catch.hpp>

#include <algorithm>

#include <controller/life/life_table.hpp>

namespace life_table_test {

using namespace busbar::controller::detail;

namespace {

bool has(LifePhase phase, LifeEvent event)
{
    return life_step(phase, event) != nullptr;
}

constexpr auto last_phase = static_cast<int>(LifePhase::Stopped);

} // namespace

TEST_CASE("Each event of a state leads to one other (4-2-4)")
{
    for (const LifeStep& step : life_steps) {
        CHECK(std::count_if(life_steps.begin(), life_steps.end(), [&](const LifeStep& other) {
                  return other.phase == step.phase && other.event == step.event;
              }) == 1);
    }
}

TEST_CASE("Power and a reset are possible in every state (4-1-1)")
{
    for (int phase = 0; phase <= last_phase; ++phase) {
        // It has begun already.
        if (static_cast<LifePhase>(phase) != LifePhase::Resetting) {
            CHECK(has(static_cast<LifePhase>(phase), LifeEvent::Restart));
        }
    }
}

TEST_CASE("No state lets clients in but Running (4-2-4)")
{
    for (const LifeStep& step : life_steps) {
        CHECK((step.action == LifeAction::Run) ==
              (step.next == LifePhase::Running && step.phase != LifePhase::Running));
        const bool leaves = step.phase == LifePhase::Running && step.next != LifePhase::Running;
        CHECK((!leaves || step.action == LifeAction::Stop || step.action == LifeAction::Suspend ||
               step.action == LifeAction::Reconfigure));
    }
}

TEST_CASE("What is shut down comes back by a restart only (4-1-2)")
{
    for (const LifeStep& step : life_steps) {
        if (step.phase == LifePhase::Stopped || step.phase == LifePhase::NotStarted ||
            step.phase == LifePhase::Broken) {
            const bool restarts = step.event == LifeEvent::Restart;
            CHECK(restarts == (step.next == LifePhase::Initializing));
        }
    }
}

} // namespace life_table_test
