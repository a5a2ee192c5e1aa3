#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/controller/machine_event_raiser.hpp>

#include "machine_event_world.hpp"
#include "support/effort.hpp"

namespace machine_event_files_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

TEST_CASE_METHOD(EventWorld, "Events are kept through restarts, the last ones (9-2-2)")
{
    happen(RecordKind::ServerStarted);
    clock.time = later(example_start, 10'000);
    refuse(0, 2);
    REQUIRE(log->write_pending());
    const auto before = log->events();
    restart();
    happen(RecordKind::ServerStarted); // before anything is read
    REQUIRE(log->load());
    const auto after = log->events();
    CHECK(short_events(after) ==
          Texts{"95D00000", "85600000 01,user0", "85600000 01,user1", "95D00000"});
    CHECK(after[1].time == before[1].time);
    CHECK(after[1].level == before[1].level);
    CHECK(after[3].number == 4);
    REQUIRE(log->write_pending());
    restart();
    REQUIRE(log->load());
    CHECK(short_events(log->events()) == short_events(after));
}

TEST_CASE("At most so many events are kept, and two files of them (9-2-2)")
{
    EventWorld world{{.max_entries = 16}};
    std::size_t count = 0;
    for (int i = 0; i < 10; ++i) {
        world.refuse(i * 10, 10);
        count += 10;
        REQUIRE(world.log->write_pending());
        CHECK(world.storage.names().size() <= 2);
        CHECK(world.log->events().size() == std::min<std::size_t>(16, count));
        const auto expected = short_events(world.log->events());
        world.restart();
        REQUIRE(world.log->load());
        CHECK(short_events(world.log->events()) == expected);
        CHECK(world.log->events().back().number == count);
    }
    // More at once than are kept: the last ones are.
    world.refuse(100, 40);
    REQUIRE(world.log->write_pending());
    world.restart();
    REQUIRE(world.log->load());
    CHECK(short_events(world.log->events()).front() == "85600000 01,user124");
    CHECK(short_events(world.log->events()).back() == "85600000 01,user139");
}

TEST_CASE("Whatever the power cuts or the storage fails, events stay and come once (9-2-2)",
          "[power_cut][logs]")
{
    for (const bool is_cut : {true, false}) {
        bool is_through = false;
        const Turns cuts{is_cut ? "cut" : "failed", 3};
        for (std::size_t steps = cuts.first; !is_through; steps += cuts.stride) {
            EventWorld world{{.max_entries = 16}};
            world.refuse(0, 14);
            REQUIRE(world.log->write_pending());
            if (is_cut) {
                world.storage.cut_power_after(steps);
            } else {
                world.storage.fail_once_after(steps, StorageError::Failed);
            }
            world.refuse(14, 4);
            is_through = world.log->write_pending().has_value();
            world.storage.restore_power();
            if (!is_cut) {
                REQUIRE(world.log->write_pending());
            }
            world.restart();
            REQUIRE(world.log->load());
            const auto events = world.log->events();
            INFO((is_cut ? "cut" : "failed") << " after " << steps);
            REQUIRE(events.size() >= 14);
            if (is_through || !is_cut) {
                REQUIRE(events.back().number == 18);
            }
            for (std::size_t i = 0; i < events.size(); ++i) {
                const std::uint64_t number = events.front().number + i;
                REQUIRE(events[i].number == number);
                REQUIRE(events[i].attached.at(1) == "user" + std::to_string(number - 1));
            }
        }
    }
}

TEST_CASE_METHOD(EventWorld, "Lines of an event file that are none do no harm (9-2-2)")
{
    const std::string good = "7\t2017-10-17T14:52:50.747Z\t95D00000\tInformation\r\n";
    const std::string lines = "x\r\n\r\n-1\t\t\t\r\n" + good +
                              "8\tno time\t95D00000\tInformation\r\n"
                              "8\t2017-10-17T14:52:50Z\t00000009\tInformation\r\n"
                              "8\t2017-10-17T14:52:50Z\t95D00000\tSomewhat\r\n" +
                              good + "a line feed alone\n" +
                              "9\t2017-10-17T14:52:50Z\t95D00000\tInformation\tcut off";
    REQUIRE(storage.make_folder("events", FileAccess::Everyone));
    REQUIRE(storage.replace("events/events.log", std::as_bytes(std::span{lines}),
                            FileAccess::Everyone));
    REQUIRE(log->load());
    CHECK(short_events(log->events()) == Texts{"95D00000"});
    happen(RecordKind::ServerShutDown);
    CHECK(log->events().back().number == 8);
    REQUIRE(log->write_pending());
    restart();
    REQUIRE(log->load());
    CHECK(short_events(log->events()) == Texts{"95D00000", "95D10000"});
}

TEST_CASE("An event is raised at the controller's folder with its code (9-1-2)")
{
    model::AddressSpace space;
    model::NewNode node;
    node.id = NodeId{space.add_namespace("urn:press").value(), "Press"};
    node.browse_name = {node.id.namespace_index(), "Press"};
    node.parent = space.find(id::ObjectsFolder);
    const auto folder = space.add_folder(node);
    REQUIRE(folder);
    StandingClock clock;
    MachineEventRaiser raiser;
    const MachineEvent event{
        1, example_start, machine_event_type(0x35D40000), EventLevel::Observation, {"21"}};
    raiser.happened(event); // before there is a server
    const auto queue = std::make_shared<server::EventQueue>(clock, nullptr, 8);
    REQUIRE(raiser.attach(space, *folder, queue));
    REQUIRE(raiser.attach(space, *folder, queue)); // of the next server
    raiser.happened(event);
    queue->begin();
    server::Event raised;
    REQUIRE(queue->next(raised));
    CHECK(raised.message.text == "35D40000 Unsupported Data Type: 21");
    CHECK(raised.severity == 400);
    CHECK(raised.source_node == node.id);
    CHECK(raised.source_name == "OPC UA Server");
    CHECK(raised.time == example_start);
    CHECK(space.find(raised.event_type) != model::no_node);
    CHECK_FALSE(queue->next(raised));
    queue->close();
}

} // namespace machine_event_files_test
