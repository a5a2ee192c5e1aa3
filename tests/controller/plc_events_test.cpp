#include <catch2/catch.hpp>

#include <atomic>
#include <string>
#include <thread>

#include <busbar/controller/plc_events.hpp>
#include <busbar/controller/plc_nodes.hpp>
#include <busbar/controller/plc_task.hpp>

#include "support/allocation_count.hpp"
#include "support/source_caller.hpp"

namespace plc_events_test {

using namespace busbar;
using namespace busbar::controller;
using namespace std::chrono_literals;

namespace {

class FixedClock final : public WallClock {
public:
    DateTime now() const override { return DateTime::from_unix_seconds(4711); }
};

PlcEvent event(std::string variable, double limit, std::uint16_t severity)
{
    PlcEvent result;
    result.variable = std::move(variable);
    result.limit = limit;
    result.severity = severity;
    result.message = result.variable + " is high";
    return result;
}

/// A wave between -10 and 10 every eight scans, and a Boolean that changes every four.
PlcConfig waves()
{
    PlcConfig config;
    config.variables.resize(2);
    config.variables[0].name = "Level";
    config.variables[0].type = BuiltInType::Int16;
    config.variables[1].name = "Open";
    config.variables[1].type = BuiltInType::Boolean;
    config.programs.resize(2);
    config.programs[0].kind = PlcProgramKind::Sine;
    config.programs[0].target = "Level";
    config.programs[0].period = 80ms;
    config.programs[0].amplitude = 10;
    config.programs[1].kind = PlcProgramKind::Toggle;
    config.programs[1].target = "Open";
    config.programs[1].period = 40ms;
    config.events = {event("Level", 0, 300), event("Level", 9, 700), event("Open", 0, 500)};
    return config;
}

} // namespace

TEST_CASE("an event happens in the scan in which a value passes its limit")
{
    const auto plc = std::move(Plc::create(waves()).value());
    std::vector<std::vector<std::uint32_t>> happened;
    for (int i = 0; i < 16; ++i) {
        plc->scan(DateTime::from_unix_seconds(i), 10ms);
        const auto occurrences = plc->occurrences();
        happened.emplace_back(occurrences.begin(), occurrences.end());
    }
    // The first scan finds the wave above 0: that it is so does not happen.
    const std::vector<std::vector<std::uint32_t>> expected = {{},  {1}, {}, {2}, {}, {}, {}, {},
                                                              {0}, {1}, {}, {2}, {}, {}, {}, {}};
    CHECK(happened == expected);
}

TEST_CASE("what happens is raised at its variable, below a notifier",
          "[unit:Address Space Notifier Hierarchy]"
          "[unit:Address Space Source Hierarchy]")
{
    const auto plc = std::move(Plc::create(waves()).value());
    model::AddressSpace space;
    const auto folder = publish_variables(space, *plc, {});
    REQUIRE(folder);
    const FixedClock clock;
    const auto queue = std::make_shared<server::EventQueue>(clock, nullptr, 8);
    const auto events = PlcEvents::create(space, *folder, *plc, queue);
    REQUIRE(events);

    const auto level = space.find(NodeId{space.node_id(*folder).namespace_index(), "Level"});
    CHECK(
        space.add_reference(space.find(id::Server), NodeId{0, id::HasNotifier}, *folder).error() ==
        status::Bad_DuplicateReferenceNotAllowed);
    CHECK(space.add_reference(*folder, NodeId{0, id::HasEventSource}, level).error() ==
          status::Bad_DuplicateReferenceNotAllowed);

    server::Event raised;
    for (int i = 0; i < 2; ++i) {
        const DateTime time = DateTime::from_unix_seconds(100 + i);
        plc->scan(time, 10ms);
        events->raise(time);
    }
    REQUIRE(queue->next(raised));
    CHECK(raised.event_type == NodeId{0, id::BaseEventType});
    CHECK(raised.source_node == space.node_id(level));
    CHECK(raised.source_name == "Level");
    CHECK(raised.message == LocalizedText{"Level is high"});
    CHECK(raised.severity == 700);
    CHECK(raised.time == DateTime::from_unix_seconds(101));
    CHECK_FALSE(queue->next(raised));
    queue->close();
}

TEST_CASE("the thread that scans neither allocates nor frees for its events")
{
    PlcConfig config = waves();
    config.events[0].message = std::string(200, '!'); // longer than what fits a string itself
    const auto plc = std::move(Plc::create(config).value());
    model::AddressSpace space;
    const auto folder = publish_variables(space, *plc, {});
    REQUIRE(folder);
    const FixedClock clock;
    const auto queue = std::make_shared<server::EventQueue>(clock, nullptr, 8);
    const auto events = PlcEvents::create(space, *folder, *plc, queue);
    REQUIRE(events);

    std::size_t raised = 0;
    std::size_t calls = 0;
    for (int i = 0; i < 200; ++i) { // more than the queue has places for, and some are taken out
        const std::size_t before = test::allocation_count() + test::free_count();
        plc->scan(DateTime::from_unix_seconds(i), 10ms);
        events->raise(DateTime::from_unix_seconds(i));
        calls += test::allocation_count() + test::free_count() - before;
        raised += plc->occurrences().size();
        server::Event event;
        if (i % 50 == 0) {
            while (queue->next(event)) {
                CHECK_FALSE(event.message.text.empty());
            }
        }
    }
    CHECK(raised > 50);
    CHECK(queue->dropped() > 0);
    CHECK(calls == 0);
    queue->close();
}

TEST_CASE("a running task neither allocates nor frees, whatever clients do")
{
    PlcConfig config = waves();
    PlcVariable& recipe = config.variables.emplace_back();
    recipe.name = "Recipe";
    recipe.type = BuiltInType::String;
    recipe.capacity = 200;
    const auto plc = std::move(Plc::create(config).value());
    model::AddressSpace space;
    const auto folder = publish_variables(space, *plc, {});
    REQUIRE(folder);
    const FixedClock clock;
    const auto queue = std::make_shared<server::EventQueue>(clock, nullptr, 8);
    const auto events = PlcEvents::create(space, *folder, *plc, queue);
    REQUIRE(events);

    std::atomic<std::size_t> calls{0}; // of the task's thread, from its begin on
    PlcTask task{*plc, clock, 1ms};
    task.after_scan([&](DateTime time) {
        events->raise(time);
        calls = test::calls_of_thread();
    });
    server::ImageSource source{plc->image()};
    test::SourceCaller caller{source};
    const std::uint32_t handle = *plc->find("Recipe");
    const DataValue text{Variant{String{std::string(200, '!')}}};
    plc->image()->follow_scans(true);
    task.start();
    while (!plc->image()->is_running()) { // a Write before the first scan is refused
        std::this_thread::yield();
    }
    int raised = 0;
    for (int writes = 0; writes < 50 || raised < 10; ++writes) {
        REQUIRE(caller.write({{handle, nullptr, &text}}) == std::vector{StatusCode{status::Good}});
        REQUIRE(caller.read({handle})[0].value == text.value);
        while (plc->image()->next_scan()) {
        }
        server::Event event;
        while (queue->next(event)) {
            ++raised;
        }
    }
    task.stop();
    plc->image()->follow_scans(false);
    CHECK(calls == 0);
    CHECK(test::calls_of_thread() != 0); // here it is counted
    queue->close();
}

} // namespace plc_events_test
