#include "label_world.hpp"

namespace label_subscription_test {

// Subscriptions to labels of a simulated PLC, in each sampling mode, and labels that change.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const std::string before = "Speed : INT := 10; Other : INT := 20; Blank : INT;";
const std::string retyped = "Blank : INT; Other : DINT := 21; More : REAL; Speed : INT := 11;";
const std::string without = "Speed : INT; Blank : INT;";

struct Fixture : LabelWorld {
    explicit Fixture(SamplingMode mode, controller::SimulatedLabelsOptions options = {})
        : LabelWorld{"", before, {.sampling = mode, .labels = options}}
    {
        add("speed", NodeId{0, id::Int16}, "Speed");
        add("other", NodeId{0, id::Int16}, "Other");
        add("blank", NodeId{0, id::Int16}, "Blank");
    }
    /// The next notification that is about more than labels being updated (10.3).
    std::vector<std::pair<std::uint32_t, DataValue>> next_values()
    {
        auto values = next();
        while (!values.empty() && values[0].second.status == status::Good_Overload) {
            values = next();
        }
        return values;
    }
    void check_next(std::uint32_t item, std::int16_t value)
    {
        const auto values = next_values();
        REQUIRE(values.size() == 1);
        CHECK(values[0].first == item);
        CHECK(values[0].second.value == Variant{value});
        CHECK(values[0].second.status == status::Good);
    }
};

const std::vector<LabelUpdate> well{LabelUpdate::Started, LabelUpdate::Finished};

} // namespace

TEST_CASE("9.12 Sampling modes: each shows a simulated PLC's values and changes", "[8.3][9.12]")
{
    const auto mode =
        GENERATE(SamplingMode::Standard, SamplingMode::MonitoredItems, SamplingMode::AllVariables);
    Fixture world{mode};
    world.start();
    world.monitor({"speed", "other"});
    const auto first = world.next();
    REQUIRE(first.size() == 2);
    CHECK(first[0].second.value == Variant{std::int16_t{10}});
    CHECK(first[1].second.value == Variant{std::int16_t{20}});
    world.variable<std::int16_t>("Other") = 22;
    world.check_next(1, 22);
    CHECK(world.write("speed", Variant{std::int16_t{-3}}) == status::Good);
    world.check_next(0, -3);
    CHECK(world.book.errors.empty());
}

TEST_CASE("9.12 Sampling modes: a Read waits for the PLC unless all Variables are sampled",
          "[8.3][9.12]")
{
    const auto mode =
        GENERATE(SamplingMode::Standard, SamplingMode::MonitoredItems, SamplingMode::AllVariables);
    // A request and a sample beside: were it asked, the PLC would take three scans.
    Fixture world{mode, {.access_unit = 1}};
    world.start();
    world.run_scans(10);
    static_cast<void>(world.read("blank"));
    const TimePoint begin = world.world().now();
    const auto values = world.read_all({"speed", "other", "blank"});
    CHECK(values[2].status == status::Good);
    CHECK((world.world().now() - begin < LabelWorld::scan_cycle) ==
          (mode == SamplingMode::AllVariables));
}

TEST_CASE("8.3 High-speed sampling: a simulated PLC's refusals (1941H, 1945H, 1946H)", "[8.3]")
{
    struct Row {
        controller::SimulatedLabelsOptions options;
        const char* address;
        MappedErrorCode code;
    };
    const Row row = GENERATE(Row{{.max_sampled_points = 8'191}, "", MappedErrorCode::TooManyPoints},
                             Row{{}, "FD3", MappedErrorCode::UnsampledDevice},
                             Row{{.can_sample = false}, "", MappedErrorCode::SamplingUnsupported});
    // Declarations have no addresses of a PLC's own.
    controller::Program program = LabelWorld::program_of("", "X : INT;");
    program.variables[0].address = row.address;
    LabelWorld world{std::move(program),
                     {.sampling = SamplingMode::AllVariables, .labels = row.options}};
    world.add("x", NodeId{0, id::Int16}, "X");
    world.start();
    world.run_scans(3);
    CHECK(world.read("x").status == status::Bad_NoCommunication);
    CHECK(world.book.errors == std::vector{row.code});
}

TEST_CASE("8.3 Label update: a simulated PLC's other program is followed in each mode",
          "[8.3][10.3]")
{
    const auto mode =
        GENERATE(SamplingMode::Standard, SamplingMode::MonitoredItems, SamplingMode::AllVariables);
    Fixture world{mode};
    world.start();
    world.monitor({"speed", "other"});
    REQUIRE(world.next().size() == 2);
    world.variable<std::int16_t>("Speed") = 12;
    world.check_next(0, 12);
    world.book.events.clear();
    world.download("", retyped);
    // Speed is kept, and Other of another type begins anew.
    const auto changed = world.next_values();
    CHECK(world.book.events == well);
    REQUIRE(changed.size() == 2);
    CHECK(changed[0].second.value == Variant{std::int16_t{12}});
    CHECK(changed[1].second.value == Variant{std::int16_t{21}});
    const auto values = world.read_all({"speed", "other"});
    CHECK(values[0].value == Variant{std::int16_t{12}});
    CHECK(values[1].value == Variant{std::int16_t{21}});
    CHECK(world.write("other", Variant{std::int16_t{5}}) == status::Good);
    CHECK(world.variable<std::int32_t>("Other") == 5);
    world.check_next(1, 5);
}

TEST_CASE("8.3 Label update: labels that go answer Bad_NoCommunication until they are back",
          "[8.3]")
{
    const auto mode =
        GENERATE(SamplingMode::Standard, SamplingMode::MonitoredItems, SamplingMode::AllVariables);
    Fixture world{mode};
    world.start();
    world.monitor({"speed"});
    REQUIRE(world.next().size() == 1);
    world.book.events.clear();
    world.download("", without);
    world.run_scans(3);
    CHECK(world.book.events == std::vector{LabelUpdate::Started, LabelUpdate::Failed});
    CHECK(world.book.errors == std::vector{MappedErrorCode::Unavailable});
    CHECK(world.book.label == "Other");
    CHECK(world.read("speed").status == status::Bad_NoCommunication);
    CHECK(world.write("speed", Variant{std::int16_t{1}}) == status::Bad_NoCommunication);
    const auto failed = world.next_values();
    REQUIRE(failed.size() == 1);
    CHECK(failed[0].second.status == status::Bad_NoCommunication);

    world.download("", before);
    world.run_scans(3);
    CHECK(world.read("speed").status == status::Good);
    const auto back = world.next_values();
    REQUIRE(back.size() == 1);
    CHECK(back[0].second.value == Variant{std::int16_t{10}});
}

TEST_CASE("10.3 Label update: MonitoredItems have their last values with Good_Overload meanwhile",
          "[10.3]")
{
    Fixture world{SamplingMode::Standard};
    world.start();
    world.monitor({"speed"});
    REQUIRE(world.next().size() == 1);
    // Names are resolved at the end of a scan: of one that takes its time.
    world.stop_scans();
    world.download("", retyped);
    world.world().run_for(250ms);
    CHECK(world.source.is_updating());
    const auto last = world.next();
    REQUIRE(last.size() == 1);
    CHECK(last[0].second.value == Variant{std::int16_t{10}});
    CHECK(last[0].second.status == status::Good_Overload);
    world.go_on_scanning();
    world.check_next(0, 10);
    CHECK_FALSE(world.source.is_updating());
}

} // namespace label_subscription_test
