#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <thread>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_task.hpp>

#include "support/source_caller.hpp"

namespace plc_test {

using namespace busbar;
using namespace busbar::controller;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 20ms;

PlcVariable variable(std::string name, BuiltInType type, Variant initial = {},
                     std::vector<std::uint32_t> dimensions = {})
{
    PlcVariable result;
    result.name = std::move(name);
    result.type = type;
    result.initial = std::move(initial);
    result.dimensions = std::move(dimensions);
    return result;
}

PlcProgram program(PlcProgramKind kind, std::string target, std::chrono::milliseconds period = 0ms)
{
    PlcProgram result;
    result.kind = kind;
    result.target = std::move(target);
    result.period = period;
    return result;
}

/// A PLC in virtual time, and a server's view of it.
struct Machine {
    explicit Machine(const PlcConfig& config) : plc{std::move(Plc::create(config).value())} {}

    void run(int scans, Duration elapsed = cycle)
    {
        for (int i = 0; i < scans; ++i) {
            now.ticks += elapsed.count() / 100;
            plc->scan(now, elapsed);
        }
    }
    Variant operator[](std::string_view name) const
    {
        return plc->image()->pin().value(plc->find(name).value());
    }

    DateTime now{DateTime::from_unix_seconds(1000)};
    std::unique_ptr<Plc> plc;
};

class StoppedClock final : public WallClock {
public:
    DateTime now() const override { return DateTime::from_unix_seconds(4711); }
};

} // namespace

TEST_CASE("variables begin with zeros and empty texts, or with what the configuration says")
{
    PlcConfig config;
    config.variables = {
        variable("Count", BuiltInType::UInt16, std::int64_t{65535}),
        variable("Level", BuiltInType::Float, 1.5),
        variable("Whole", BuiltInType::Byte, 3.0),
        variable("Empty", BuiltInType::Int64),
        variable("Title", BuiltInType::String, "BB-1"),
        variable("Note", BuiltInType::String),
        variable("Bytes", BuiltInType::ByteString, "ab"),
        variable("Key", BuiltInType::Guid, "72962B91-FA75-4AE6-8D28-B404DC7DAF63"),
        variable("Born", BuiltInType::DateTime, DateTime{42}),
        variable("Recipe", BuiltInType::Int16, Array<std::int64_t>{1, 2, 3}, {3}),
        variable("Filled", BuiltInType::Boolean, true, {2}),
        variable("Names", BuiltInType::String, Array<String>{"a", "b"}, {2}),
        variable("Grid", BuiltInType::Double, Array<double>{1, 2, 3, 4}, {2, 2}),
    };
    Machine machine{config};
    machine.run(1);
    CHECK(machine["Count"] == Variant{std::uint16_t{65535}});
    CHECK(machine["Level"] == Variant{1.5F});
    CHECK(machine["Whole"] == Variant{std::uint8_t{3}});
    CHECK(machine["Empty"] == Variant{std::int64_t{0}});
    CHECK(machine["Title"] == Variant{"BB-1"});
    CHECK(machine["Note"] == Variant{""});
    CHECK(machine["Bytes"] == Variant{ByteString{std::as_bytes(std::span{"ab", 2})}});
    CHECK(machine["Key"] == Variant{Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63").value()});
    CHECK(machine["Born"] == Variant{DateTime{42}});
    CHECK(machine["Recipe"] == Variant{Array<std::int16_t>{1, 2, 3}});
    CHECK(machine["Filled"] == Variant{Array<bool>{true, true}});
    CHECK(machine["Names"] == Variant{Array<String>{"a", "b"}});
    CHECK(machine["Grid"] ==
          Variant::matrix(Array<double>{1, 2, 3, 4}, Array<std::uint32_t>{2, 2}));
    CHECK_FALSE(machine.plc->find("Nothing"));
}

TEST_CASE("a count makes many variables of one kind")
{
    PlcConfig config;
    config.variables = {variable("Bulk", BuiltInType::Int16, std::int64_t{5})};
    config.variables[0].count = 12;
    config.programs = {program(PlcProgramKind::Increment, "Bulk"),
                       program(PlcProgramKind::Increment, "Bulk3")};
    Machine machine{config};
    machine.run(1);
    CHECK(machine.plc->variables().size() == 12);
    CHECK(machine["Bulk0"] == Variant{std::int16_t{6}});
    CHECK(machine["Bulk3"] == Variant{std::int16_t{7}});
    CHECK(machine["Bulk11"] == Variant{std::int16_t{6}});
    CHECK_FALSE(machine.plc->find("Bulk"));
}

TEST_CASE("increment counts scans or periods, and integers start over")
{
    PlcConfig config;
    config.variables = {variable("Fast", BuiltInType::Int32), variable("Slow", BuiltInType::Double),
                        variable("Small", BuiltInType::SByte, std::int64_t{126}),
                        variable("Down", BuiltInType::UInt64),
                        variable("All", BuiltInType::UInt16, {}, {2})};
    config.programs = {program(PlcProgramKind::Increment, "Fast"),
                       program(PlcProgramKind::Increment, "Slow", 100ms),
                       program(PlcProgramKind::Increment, "Small"),
                       program(PlcProgramKind::Increment, "Down"),
                       program(PlcProgramKind::Increment, "All")};
    config.programs[1].amplitude = 0.5;
    config.programs[3].amplitude = -1;
    Machine machine{config};
    machine.run(4);
    CHECK(machine["Fast"] == Variant{std::int32_t{4}});
    CHECK(machine["Slow"] == Variant{0.0});
    CHECK(machine["Small"] == Variant{std::int8_t{-126}});
    CHECK(machine["Down"] == Variant{std::uint64_t{0} - 4});
    CHECK(machine["All"] == Variant{Array<std::uint16_t>{4, 4}});
    machine.run(1);
    CHECK(machine["Slow"] == Variant{0.5});
    machine.run(1, 1s); // ten periods in one long scan
    CHECK(machine["Slow"] == Variant{5.5});
    machine.run(1, -1s); // no time can be taken back
    CHECK(machine["Slow"] == Variant{5.5});
}

TEST_CASE("sine goes through its wave and keeps to the type's limits")
{
    PlcConfig config;
    config.variables = {variable("Wave", BuiltInType::Double), variable("Cut", BuiltInType::Byte),
                        variable("Wide", BuiltInType::Int64),
                        variable("Phases", BuiltInType::Int16, {}, {4})};
    for (const PlcVariable& v : config.variables) {
        config.programs.push_back(program(PlcProgramKind::Sine, v.name, 400ms));
    }
    config.programs[0].amplitude = 2;
    config.programs[0].offset = 10;
    config.programs[1].amplitude = 1000;
    config.programs[2].amplitude = 1e30;
    config.programs[3].amplitude = 100;
    Machine machine{config};
    machine.run(5); // a quarter
    CHECK(machine["Wave"].value_or(0.0) == Approx(12.0));
    CHECK(machine["Cut"] == Variant{std::uint8_t{255}});
    CHECK(machine["Wide"] == Variant{INT64_MAX});
    CHECK(machine["Phases"] == Variant{Array<std::int16_t>{100, 0, -100, 0}});
    machine.run(10); // three quarters
    CHECK(machine["Wave"].value_or(0.0) == Approx(8.0));
    CHECK(machine["Cut"] == Variant{std::uint8_t{0}});
    CHECK(machine["Wide"] == Variant{INT64_MIN});
}

TEST_CASE("toggle inverts, copy follows")
{
    PlcConfig config;
    config.variables = {variable("Lamp", BuiltInType::Boolean),
                        variable("Mirror", BuiltInType::Boolean),
                        variable("Lamps", BuiltInType::Boolean, Array<bool>{true, false}, {2}),
                        variable("Text", BuiltInType::String, "hello"),
                        variable("Echo", BuiltInType::String),
                        variable("Texts", BuiltInType::String, Array<String>{"a", "b"}, {2}),
                        variable("Echoes", BuiltInType::String, {}, {2}),
                        variable("One", BuiltInType::Int16, std::int64_t{3}),
                        variable("Many", BuiltInType::Int16)};
    config.variables[8].count = 2;
    config.programs = {
        program(PlcProgramKind::Toggle, "Lamp", 40ms), program(PlcProgramKind::Copy, "Mirror"),
        program(PlcProgramKind::Toggle, "Lamps"),      program(PlcProgramKind::Copy, "Echo"),
        program(PlcProgramKind::Copy, "Echoes"),       program(PlcProgramKind::Copy, "Many")};
    config.programs[1].source = "Lamp";
    config.programs[3].source = "Text";
    config.programs[4].source = "Texts";
    config.programs[5].source = "One";
    Machine machine{config};
    machine.run(1);
    CHECK(machine["Lamp"] == Variant{false});
    CHECK(machine["Lamps"] == Variant{Array<bool>{false, true}});
    CHECK(machine["Echo"] == Variant{"hello"});
    CHECK(machine["Echoes"] == Variant{Array<String>{"a", "b"}});
    CHECK(machine["Many1"] == Variant{std::int16_t{3}});
    machine.run(1);
    CHECK(machine["Lamp"] == Variant{true});
    CHECK(machine["Mirror"] == Variant{true});
    machine.run(1, 80ms); // two periods at once
    CHECK(machine["Lamp"] == Variant{true});
}

TEST_CASE("acknowledge takes bit 0 and sets what it is for")
{
    PlcConfig config;
    config.variables = {variable("Handle", BuiltInType::UInt16, std::int64_t{0xFFFE}),
                        variable("State", BuiltInType::Byte, std::int64_t{4}),
                        variable("Quiet", BuiltInType::Int32, std::int64_t{3})};
    config.programs = {program(PlcProgramKind::Acknowledge, "Handle", 40ms),
                       program(PlcProgramKind::Acknowledge, "Quiet")};
    config.programs[0].sets = "State";
    config.programs[0].to = 6.4;
    Machine machine{config};
    machine.run(2);
    CHECK(machine["Handle"] == Variant{std::uint16_t{0xFFFE}});
    CHECK(machine["State"] == Variant{std::uint8_t{4}});
    CHECK(machine["Quiet"] == Variant{std::int32_t{2}});

    CHECK(machine.plc->image()->memory().store(0, Variant{std::uint16_t{0xFFFF}}).is_good());
    machine.run(1);
    CHECK(machine["Handle"] == Variant{std::uint16_t{0xFFFF}}); // its period is not over
    machine.run(1);
    CHECK(machine["Handle"] == Variant{std::uint16_t{0xFFFE}});
    CHECK(machine["State"] == Variant{std::uint8_t{6}});
}

TEST_CASE("logic of a runtime runs instead of the programs, which it may run")
{
    struct Doubling final : PlcLogic {
        explicit Doubling(Plc& of) : plc{of} {}
        void scan(DateTime now, Duration elapsed) override
        {
            last = now;
            if (runs_programs) {
                plc.run_programs(elapsed);
            }
            plc.image()->memory().value<std::int32_t>(0) *= 2;
        }
        Plc& plc;
        DateTime last{};
        bool runs_programs{false};
    };
    PlcConfig config;
    config.variables = {variable("Count", BuiltInType::Int32, std::int64_t{3})};
    config.programs = {program(PlcProgramKind::Increment, "Count")};
    Machine machine{config};
    Doubling doubling{*machine.plc};
    machine.plc->use(doubling);
    machine.run(1);
    CHECK(machine["Count"] == Variant{std::int32_t{6}});
    CHECK(doubling.last == machine.now);
    doubling.runs_programs = true;
    machine.run(1);
    CHECK(machine["Count"] == Variant{std::int32_t{14}});
}

TEST_CASE("what clients write is there for the programs of the same scan")
{
    PlcConfig config;
    config.variables = {variable("In", BuiltInType::Int32), variable("Out", BuiltInType::Int32),
                        variable("Fixed", BuiltInType::Int32)};
    config.variables[2].is_writable = false;
    config.programs = {program(PlcProgramKind::Copy, "Out")};
    config.programs[0].source = "In";
    Machine machine{config};
    machine.run(1);
    server::ImageSource source{machine.plc->image()};
    test::SourceCaller caller{source};
    std::vector<StatusCode> results;
    const DataValue seven{Variant{std::int32_t{7}}};
    std::atomic<bool> done{false};
    std::thread client{[&] {
        results = caller.write({{*machine.plc->find("In"), nullptr, &seven},
                                {*machine.plc->find("Fixed"), nullptr, &seven}});
        done = true;
    }};
    while (!done) {
        machine.run(1);
    }
    client.join();
    CHECK(results == std::vector<StatusCode>{status::Good, status::Bad_NotWritable});
    CHECK(machine["Out"] == Variant{std::int32_t{7}});
    CHECK(machine["Fixed"] == Variant{std::int32_t{0}});
}

namespace {

/// What a mistake in a good configuration is answered with.
struct Mistake {
    const char* what;
    void (*make)(PlcConfig&);
    std::size_t index;
    const char* field;
};

const Mistake variable_mistakes[] = {
    {"no name", [](PlcConfig& c) { c.variables[1].name = ""; }, 1, "name"},
    {"a name twice", [](PlcConfig& c) { c.variables[1].name = "A"; }, 1, "name"},
    {"a name that a count makes again",
     [](PlcConfig& c) {
         c.variables[1].count = 3;
         c.variables.push_back(variable("T1", BuiltInType::Int16));
     },
     2, "name"},
    {"a type that no PLC has", [](PlcConfig& c) { c.variables[1].type = BuiltInType::NodeId; }, 1,
     "type"},
    {"a dimension of nothing",
     [](PlcConfig& c) {
         c.variables[1].dimensions = {2, 0};
     },
     1, "dimensions"},
    {"too much memory", [](PlcConfig& c) { c.variables[1].count = 4'000'000'000U; }, 1,
     "dimensions"},
    {"an initial value of another type", [](PlcConfig& c) { c.variables[1].initial = 5.0; }, 1,
     "initial"},
    {"a number out of range", [](PlcConfig& c) { c.variables[0].initial = std::int64_t{32768}; }, 0,
     "initial"},
    {"a fraction", [](PlcConfig& c) { c.variables[0].initial = 0.5; }, 0, "initial"},
    {"an array for a scalar", [](PlcConfig& c) { c.variables[0].initial = Array<std::int64_t>{1}; },
     0, "initial"},
    {"too few elements",
     [](PlcConfig& c) {
         c.variables[0].dimensions = {2};
         c.variables[0].initial = Array<std::int64_t>{1};
     },
     0, "initial"},
    {"a text that is too long",
     [](PlcConfig& c) {
         c.variables[1].initial = "hello";
         c.variables[1].capacity = 4;
     },
     1, "initial"},
};

const Mistake program_mistakes[] = {
    {"a program for nothing", [](PlcConfig& c) { c.programs[0].target = "B"; }, 0, "target"},
    {"a program for another type",
     [](PlcConfig& c) { c.programs[0].kind = PlcProgramKind::Toggle; }, 0, "target"},
    {"a sine without a period",
     [](PlcConfig& c) { c.programs.push_back(program(PlcProgramKind::Sine, "A")); }, 1, "period"},
    {"a negative period", [](PlcConfig& c) { c.programs[0].period = -1ms; }, 0, "period"},
    {"half an integer", [](PlcConfig& c) { c.programs[0].amplitude = 0.5; }, 0, "amplitude"},
    {"no number", [](PlcConfig& c) { c.programs[0].offset = std::nan(""); }, 0, "amplitude"},
    {"a copy of nothing", [](PlcConfig& c) { c.programs[0].kind = PlcProgramKind::Copy; }, 0,
     "source"},
    {"a copy of another type",
     [](PlcConfig& c) {
         c.programs[0].kind = PlcProgramKind::Copy;
         c.programs[0].source = "T";
     },
     0, "source"},
    {"an acknowledgement of a text",
     [](PlcConfig& c) {
         c.programs[0].kind = PlcProgramKind::Acknowledge;
         c.programs[0].target = "T";
     },
     0, "target"},
    {"an acknowledgement that sets a text",
     [](PlcConfig& c) {
         c.programs[0].kind = PlcProgramKind::Acknowledge;
         c.programs[0].sets = "T";
     },
     0, "sets"},
};

/// `change` of an event of the variable A.
template <typename Change>
void add_event(PlcConfig& config, Change change)
{
    PlcEvent event;
    event.variable = "A";
    change(event);
    config.events.push_back(event);
}

const Mistake event_mistakes[] = {
    {"an event of nothing",
     [](PlcConfig& c) { add_event(c, [](PlcEvent& e) { e.variable = "B"; }); }, 0, "variable"},
    {"an event of a text",
     [](PlcConfig& c) { add_event(c, [](PlcEvent& e) { e.variable = "T"; }); }, 0, "variable"},
    {"an event of an array",
     [](PlcConfig& c) {
         c.variables[0].dimensions = {2};
         add_event(c, [](PlcEvent&) {});
     },
     0, "variable"},
    {"no limit", [](PlcConfig& c) { add_event(c, [](PlcEvent& e) { e.limit = std::nan(""); }); }, 0,
     "limit"},
    {"an absurd severity",
     [](PlcConfig& c) {
         add_event(c, [](PlcEvent&) {});
         add_event(c, [](PlcEvent& e) { e.severity = 1001; });
     },
     1, "severity"},
};

/// `list` is the one of the PlcConfig that has the mistake.
void check_mistake(const Mistake& mistake, const std::string& list)
{
    INFO(mistake.what);
    PlcConfig config;
    config.variables = {variable("A", BuiltInType::Int16), variable("T", BuiltInType::String)};
    config.programs = {program(PlcProgramKind::Increment, "A")};
    REQUIRE(Plc::create(config));
    mistake.make(config);
    const auto plc = Plc::create(config);
    REQUIRE_FALSE(plc);
    CHECK(plc.error().status == status::Bad_ConfigurationError);
    CHECK(plc.error().where == list + "[" + std::to_string(mistake.index) + "]." + mistake.field);
    CHECK_FALSE(plc.error().text.empty());
}

} // namespace

TEST_CASE("a broken configuration is refused with the place and the reason")
{
    for (const Mistake& mistake : variable_mistakes) {
        check_mistake(mistake, "variables");
    }
    for (const Mistake& mistake : program_mistakes) {
        check_mistake(mistake, "programs");
    }
    for (const Mistake& mistake : event_mistakes) {
        check_mistake(mistake, "events");
    }
}

TEST_CASE("a task has its priority even if who starts it gives way")
{
    const auto plc = std::move(Plc::create(PlcConfig{}).value());
    const StoppedClock clock;
    ThreadMaker threads;
    const int ours = ::getpriority(PRIO_PROCESS, 0);
    int of_starter = 0;
    std::atomic<int> of_task{-100};
    std::thread{[&] { // a thread cannot raise its priority again
        ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), ours + 3);
        of_starter = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
        PlcTask task{*plc, clock, 1ms, 0, &threads};
        task.after_scan([&of_task](DateTime) {
            of_task = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
        });
        task.start();
        while (of_task == -100) {
            std::this_thread::yield();
        }
    }}
        .join();
    CHECK(of_starter == ours + 3);
    CHECK(of_task == ours);
}

TEST_CASE("a task says what priority the system granted")
{
    const auto plc = std::move(Plc::create(PlcConfig{}).value());
    const StoppedClock clock;
    for (const int wanted : {0, PlcTask::usual_priority}) {
        PlcTask task{*plc, clock, 1ms, wanted};
        std::atomic<int> policy{-1};
        task.after_scan([&policy](DateTime) { policy = ::sched_getscheduler(0); });
        CHECK(task.realtime_priority() == 0);
        task.start();
        const int granted = task.realtime_priority(); // at once
        while (policy == -1) {
            std::this_thread::yield();
        }
        CHECK((granted == 0 || granted == wanted));
        CHECK(policy == (granted != 0 ? SCHED_FIFO : SCHED_OTHER));
    }
}

TEST_CASE("a task scans until it is stopped, and can start again")
{
    PlcConfig config;
    config.variables = {variable("Count", BuiltInType::UInt32)};
    config.programs = {program(PlcProgramKind::Increment, "Count")};
    const auto plc = std::move(Plc::create(config).value());
    const StoppedClock clock;
    PlcTask task{*plc, clock, 1ms};
    CHECK_FALSE(plc->image()->is_running());
    const auto count = [&] {
        const server::ImagePin pin = plc->image()->pin();
        return pin ? pin.value(0).value_or(std::uint32_t{0}) : 0;
    };
    std::uint32_t before = 0;
    for (int round = 0; round < 2; ++round) {
        before = count(); // The task stands still: no scan is missing in it.
        task.start();
        while (count() < before + 5) {
            std::this_thread::yield();
        }
        task.stop();
        CHECK_FALSE(plc->image()->is_running());
    }
    const PlcTask::Statistics statistics = task.statistics();
    CHECK(statistics.scans >= 5);
    CHECK(statistics.scans == count() - before); // of the second start alone
    CHECK(statistics.worst_scan > Duration::zero());
    CHECK(plc->image()->pin().time() == clock.now());
}

} // namespace plc_test
