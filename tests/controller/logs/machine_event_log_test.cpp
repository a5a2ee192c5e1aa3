#include <catch2/catch.hpp>

#include <map>
#include <set>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/plc.hpp>

#include "machine_event_world.hpp"

namespace machine_event_log_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

Happening refused_login(std::string_view user, StatusCode status)
{
    return Happening{RecordKind::LoginRefused}.by(user).with(status);
}

Happening not_published(std::string reason, bool is_member = false)
{
    static const std::map<std::string, std::uint16_t, std::less<>> bits{
        {"MultiDimensionalArray", 0},
        {"NestedStructre", 2},
        {"Union", 3},
        {"SubscriptOfArray", 4},
        {"MaxSize", 5},
        {"MaxArrayElements", 6},
        {"MaxMembers", 7}};
    const auto bit = static_cast<unsigned>(bits.at(reason)) + (is_member ? 1U : 0U);
    return Happening{RecordKind::VariableNotPublished,
                     {text("Reason", std::move(reason)),
                      {"ErrorDetails", Variant{static_cast<std::uint16_t>(1U << bit)}}}};
}

} // namespace

TEST_CASE("There are 16 events of the server and three of its instructions (9-2-1)")
{
    struct Row {
        std::uint32_t code;
        EventLevel level;
        std::optional<EventLevel> other;
    };
    constexpr auto minor = EventLevel::MinorFault;
    constexpr auto observation = EventLevel::Observation;
    constexpr auto information = EventLevel::Information;
    const std::vector<Row> rows{{0x15000000, minor, observation}, {0x15020000, observation, {}},
                                {0x35D00000, minor, {}},          {0x35D10000, minor, observation},
                                {0x35D20000, observation, minor}, {0x35D30000, observation, {}},
                                {0x35D40000, observation, {}},    {0x35D50000, observation, {}},
                                {0x35D60000, observation, {}},    {0x44180000, minor, {}},
                                {0x85600000, observation, {}},    {0x95D00000, information, {}},
                                {0x95D10000, information, {}},    {0x95D20000, information, {}},
                                {0x95D30000, information, {}},    {0x95D40000, information, {}},
                                {0x54015000, observation, {}},    {0x54015001, observation, {}},
                                {0x54015002, observation, {}}};
    for (const Row& row : rows) {
        const MachineEventType* const type = machine_event_type(row.code);
        REQUIRE(type != nullptr);
        INFO(code_text(*type));
        CHECK(type->level == row.level);
        CHECK(type->other_level == row.other);
        CHECK_FALSE(type->name.empty());
    }
    CHECK(machine_event_types().size() == rows.size() + 6); // and ours
    std::set<std::string_view> names;
    for (const MachineEventType& type : machine_event_types()) {
        INFO(code_text(type));
        CHECK(names.insert(type.name).second);
        CHECK(type.meaning.ends_with('.'));
        CHECK(type.cause.ends_with('.'));
        // What went well needs no correction (9-2-2).
        CHECK((type.correction.empty() ? type.level == EventLevel::Information
                                       : type.correction.ends_with('.')));
    }
    CHECK(machine_event_type(0x12345678) == nullptr);
    CHECK(machine_event_source == "PLC Function Module");
    CHECK(machine_event_source_details == "OPC UA Server");
    CHECK(machine_event_category == "System");
}

TEST_CASE("Levels have severities, the highest first (9-1-2)")
{
    CHECK(severity_of(EventLevel::MajorFault) == 1'000);
    CHECK(severity_of(EventLevel::PartialFault) == 900);
    CHECK(severity_of(EventLevel::MinorFault) == 700);
    CHECK(severity_of(EventLevel::Observation) == 400);
    CHECK(severity_of(EventLevel::Information) == 100);
    CHECK(name(EventLevel::MajorFault) == "Major fault");
    CHECK(name(EventLevel::Information) == "Information");
}

TEST_CASE("A user may choose the level of some events (9-2-1)")
{
    const auto where = [](std::uint32_t code, EventLevel level) {
        storage::MemoryStorage storage;
        StandingClock clock;
        NullLog next;
        const auto log =
            MachineEventLog::create(storage, clock, next, nullptr, {.levels = {{code, level}}});
        return log ? "" : log.error().where;
    };
    CHECK(where(0x15000000, EventLevel::Observation) == "");
    CHECK(where(0x15000000, EventLevel::MinorFault) == "");
    CHECK(where(0x15000000, EventLevel::Information) == "levels[0]");
    CHECK(where(0x35D00000, EventLevel::Observation) == "levels[0]");
    CHECK(where(0x11111111, EventLevel::Observation) == "levels[0]");

    EventWorld world{{.levels = {{0x35D20000, EventLevel::MinorFault}}}};
    world.happen(RecordKind::CertificateExpiring, sample_client());
    CHECK(world.log->events().at(0).level == EventLevel::MinorFault);
    CHECK(world.log->plc_error() == PlcError{EventLevel::MinorFault, 0x35D20000});
}

TEST_CASE_METHOD(EventWorld,
                 "A log that is not saved is an error until it is again (9-2-2, 15000000)")
{
    const auto lost = [](std::uint16_t code) {
        return Happening{RecordKind::ExecutionLogLost, {{"Code", Variant{code}}}};
    };
    for (const auto& [code, text] :
         {std::pair{0x0001, "0001"}, std::pair{0x0002, "0002"}, std::pair{0x0003, "0003"},
          std::pair{0x0005, "0005"}, std::pair{0x0302, "0302"}}) {
        const auto event = std::string{"15000000 "} + text;
        CHECK(happen(lost(static_cast<std::uint16_t>(code))) == Texts{event});
        CHECK(happen(lost(static_cast<std::uint16_t>(code))) == Texts{});
        CHECK(current() == Texts{event});
    }
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x15000000});
    CHECK(happen(RecordKind::ExecutionLogSaved) == Texts{});
    CHECK(current() == Texts{});
    CHECK_FALSE(log->plc_error());
    CHECK(happen(lost(1)) == Texts{"15000000 0001"});
}

TEST_CASE_METHOD(EventWorld, "A certificate that does not match is told once (9-2-2, 15020000)")
{
    const std::string event = "15020000 192.168.250.1";
    CHECK(happen(RecordKind::CertificateHostNotNamed, sample_client()) == Texts{event});
    CHECK(happen(RecordKind::CertificateHostNotNamed, sample_client()) == Texts{});
    CHECK(current() == Texts{event});
    CHECK_FALSE(log->plc_error()); // an observation is no fault
    CHECK(happen(RecordKind::CertificateUpdated, sample_client()) == Texts{"95D20000"});
    CHECK(current() == Texts{});
    CHECK(happen(RecordKind::CertificateHostNotNamed, sample_client()) == Texts{event});
    restart();
    CHECK(happen(RecordKind::CertificateHostNotNamed, sample_client()) == Texts{event});
}

TEST_CASE_METHOD(EventWorld, "Settings that are wrong are an error until it runs (9-2-2, 35D00000)")
{
    const auto halted = [](std::string reason) {
        return Happening{RecordKind::ServerHalted, {text("Reason", std::move(reason))}};
    };
    CHECK(happen(halted("Configuration Error")) == Texts{"35D00000"});
    CHECK(happen(halted("Server Start Error")) == Texts{});
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x35D00000});
    CHECK(happen(RecordKind::ServerRunning) == Texts{});
    CHECK_FALSE(log->plc_error());
    CHECK(happen(halted("Server Start Error")) == Texts{"35D00000"});
}

TEST_CASE_METHOD(EventWorld,
                 "A certificate that expires is told once each time (9-2-2, 35D10000, 35D20000)")
{
    const std::string date = " 2022-10-03 08:19:54";
    CHECK(happen(RecordKind::CertificateExpiring, sample_client()) == Texts{"35D20000" + date});
    CHECK(happen(RecordKind::CertificateExpiring, sample_client()) == Texts{});
    CHECK(happen(RecordKind::CertificateExpired, sample_client()) == Texts{"35D10000" + date});
    CHECK(happen(RecordKind::CertificateExpired, sample_client()) == Texts{});
    CHECK(current() == Texts{"35D10000" + date});
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x35D10000});
    CHECK(happen(RecordKind::CertificateUpdated, sample_client()) == Texts{"95D20000"});
    CHECK_FALSE(log->plc_error());
    // One that is not valid yet does not expire.
    clock.time = {1};
    CHECK(happen(RecordKind::CertificateExpiring, sample_client()) == Texts{});
}

TEST_CASE_METHOD(EventWorld, "A client's certificate in trusted that expires is told (5-1-1)")
{
    Happening happening{RecordKind::CertificateExpired, {text("ListName", "trusted")}};
    CHECK(happen(happening.of(sample_client().der())) ==
          Texts{"00000000 UaClient_1@SamplePC,2022-10-03 08:19:54"});
    CHECK(log->events().at(0).level == EventLevel::Observation);
    CHECK(log->events().at(0).type->name == "Client Certificate Expired");
    CHECK(current() == Texts{});
}

TEST_CASE_METHOD(EventWorld,
                 "Too much that is published is told at each preparation (9-2-2, 35D30000)")
{
    const auto exceed = [&](std::string limit) {
        return happen(
            Happening{RecordKind::PublishingLimitExceeded, {text("Limit", std::move(limit))}});
    };
    CHECK(exceed("MaxVariables") == Texts{"35D30000"});
    CHECK(exceed("MaxValues") == Texts{"35D50000"});
    CHECK(exceed("MaxDataTypes") == Texts{"35D60000"});
    CHECK(exceed("MaxSomething") == Texts{});
    CHECK(current() == Texts{"35D30000", "35D50000", "35D60000"});
    CHECK(happen(RecordKind::ServerPreparing) == Texts{});
    CHECK(current() == Texts{});
    CHECK(exceed("MaxVariables") == Texts{"35D30000"});
}

TEST_CASE_METHOD(EventWorld,
                 "Types that cannot be published are one event with bits (9-2-2, 35D40000)")
{
    const auto bits = [&](const std::vector<Happening>& variables) {
        happen(RecordKind::ServerPreparing);
        for (const Happening& each : variables) {
            CHECK(happen(each) == Texts{});
        }
        return happen(RecordKind::VariablesCounted);
    };
    CHECK(bits({}) == Texts{});
    CHECK(bits({not_published("MultiDimensionalArray")}) == Texts{"35D40000 01"});
    CHECK(bits({not_published("MultiDimensionalArray", true)}) == Texts{"35D40000 02"});
    CHECK(bits({not_published("NestedStructre")}) == Texts{"35D40000 04"});
    CHECK(bits({not_published("Union")}) == Texts{"35D40000 08"});
    CHECK(bits({not_published("SubscriptOfArray")}) == Texts{"35D40000 10"});
    CHECK(bits({not_published("MaxSize")}) == Texts{"35D40000 20"});
    CHECK(bits({not_published("MaxArrayElements")}) == Texts{"35D40000 40"});
    CHECK(bits({not_published("MaxMembers")}) == Texts{"35D40000 80"});
    CHECK(bits({not_published("Union"), not_published("MaxSize"), not_published("Union")}) ==
          Texts{"35D40000 28"});
    CHECK(current() == Texts{"35D40000 28"});
    // Online editing counts again without a preparation.
    CHECK(happen(RecordKind::VariablesCounted) == Texts{});
}

TEST_CASE_METHOD(EventWorld, "A fatal error stands until a restart (9-2-2, 44180000)")
{
    CHECK(happen(RecordKind::ServerSystemError) == Texts{"44180000"});
    CHECK(happen(Happening{RecordKind::ServerHalted, {text("Reason", "OPC UA System Error")}}) ==
          Texts{});
    happen(RecordKind::ServerRunning);
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x44180000});
    SECTION("of the controller")
    {
        restart();
    }
    SECTION("of the server, while the machine runs")
    {
        happen(RecordKind::ServerStarted);
    }
    CHECK_FALSE(log->plc_error());
}

TEST_CASE_METHOD(EventWorld,
                 "A client that is refused is told each time, with why (9-2-2, 85600000)")
{
    CHECK(happen(refused_login("pat", status::Bad_UserAccessDenied)) == Texts{"85600000 01,pat"});
    CHECK(happen(refused_login("pat", status::Bad_UserAccessDenied)) == Texts{"85600000 01,pat"});
    CHECK(happen(refused_login("", status::Bad_IdentityTokenRejected)) ==
          Texts{"85600000 01,Anonymous"});
    CHECK(happen(refused_login("a\tb\n", status::Bad_UserAccessDenied)) ==
          Texts{"85600000 01,a?b?"});
    CHECK(happen(refused_login("pat", status::Bad_ApplicationSignatureInvalid)) ==
          Texts{"85600000 02"});
    CHECK(happen(RecordKind::CertificateRefused, sample_client()) == Texts{"85600000 02"});
    CHECK(happen(Happening{RecordKind::SessionRefused}.with(status::Bad_TooManySessions)) ==
          Texts{"85600000 04"});
    CHECK(happen(Happening{RecordKind::SessionRefused}.with(status::Bad_NonceInvalid)) == Texts{});
    CHECK(current() == Texts{});
}

TEST_CASE_METHOD(EventWorld, "What is no error is told and does not stand (9-2-2, 95D00000)")
{
    CHECK(happen(RecordKind::ServerStarted) == Texts{"95D00000"});
    CHECK(happen(RecordKind::ServerShutDown) == Texts{"95D10000"});
    CHECK(happen(RecordKind::CertificateUpdated) == Texts{"95D20000"});
    CHECK(happen(Happening{RecordKind::CertificateUpdated}.with(status::Bad_InvalidState)) ==
          Texts{});
    CHECK(happen(RecordKind::CertificateDiscarded, sample_client()) ==
          Texts{"95D30000 192.168.250.1"});
    CHECK(happen(RecordKind::SecurityCleared) == Texts{"95D40000"});
    CHECK(current() == Texts{});
}

TEST_CASE_METHOD(EventWorld, "An instruction that fails is told with its place (9-2-2, 54015000)")
{
    const auto refuse = [&](std::uint16_t error) {
        return happen(Happening{RecordKind::InstructionFailed,
                                {{"Code", Variant{error}},
                                 text("Location", "Program0"),
                                 number("Line", 12),
                                 text("Instance", "Stop1")}});
    };
    CHECK(refuse(0x5000) == Texts{"54015000 Program0,12,Stop1"});
    CHECK(refuse(0x5001) == Texts{"54015001 Program0,12,Stop1,00000000"});
    CHECK(refuse(0x5002) == Texts{"54015002 Program0,12,Stop1,00000000"});
    CHECK(refuse(0x041D) == Texts{}); // an instruction's own error, no event of the server
}

TEST_CASE_METHOD(EventWorld, "A program of the PLC gets the highest fault by GetPLCError (9-1-1)")
{
    PlcConfig config;
    config.variables = {
        {.name = "Code", .type = BuiltInType::UInt32, .dimensions = {}, .initial = {}},
        {.name = "Level", .type = BuiltInType::Byte, .dimensions = {}, .initial = {}}};
    config.programs = {
        {.kind = PlcProgramKind::PlcError, .target = "Code", .source = {}, .sets = "Level"}};
    const auto plc = Plc::create(config).value();
    const auto got = [&] {
        plc->scan(DateTime{}, Duration{1});
        const auto image = plc->image()->pin();
        return std::pair{image.value(0).value_or<std::uint32_t>(99),
                         int{image.value(1).value_or<std::uint8_t>(99)}};
    };
    const auto fail = [&](std::string level) {
        static_cast<void>(
            happen(Happening{RecordKind::MachineFault,
                             {text("Level", std::move(level)), text("Where", "CPU Unit")}}));
    };
    fail("Minor fault");
    CHECK(got() == std::pair{0U, 0}); // nobody has told it where errors are
    plc->instructions().use(*log);
    CHECK(got() == std::pair{3U, 3});
    fail("Partial fault");
    CHECK(got() == std::pair{2U, 2});
    fail("Major fault");
    CHECK(got() == std::pair{2U, 2}); // of which it does not tell
    static_cast<void>(happen(Happening{RecordKind::ServerStarted}));
    CHECK(got() == std::pair{0U, 0});
    config.programs[0].target = "Level";
    config.programs[0].sets.clear();
    CHECK(Plc::create(config));
    config.variables[1].type = BuiltInType::Boolean;
    CHECK(Plc::create(config).error().where == "programs[0].target");
}

TEST_CASE_METHOD(EventWorld, "Faults of the controller stand until a restart (4-1-3, 9-1-2)")
{
    const auto fail = [&](std::string level) {
        return happen(Happening{RecordKind::MachineFault,
                                {text("Level", std::move(level)), text("Where", "CPU Unit")}});
    };
    CHECK(fail("Minor fault") == Texts{"00000003 CPU Unit"});
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 3});
    CHECK(fail("Partial fault") == Texts{"00000002 CPU Unit"});
    CHECK(log->plc_error() == PlcError{EventLevel::PartialFault, 2});
    CHECK(fail("Major fault") == Texts{"00000001 CPU Unit"});
    CHECK(current() == Texts{"00000003 CPU Unit", "00000002 CPU Unit", "00000001 CPU Unit"});
    CHECK(log->current_errors().back().level == EventLevel::MajorFault);
    CHECK(source_details(*log->current_errors().back().type) == "CPU Unit");
    happen(RecordKind::ServerStarted);
    CHECK(current() == Texts{});
}

TEST_CASE_METHOD(EventWorld, "A storage medium close to its end is told, and is no error (7-4-5)")
{
    const Happening worn{RecordKind::MachineFault,
                         {text("Level", "Observation"), text("Where", "storage medium")}};
    CHECK(happen(worn) == Texts{"00000005 storage medium"});
    CHECK(log->events().at(0).level == EventLevel::Observation);
    CHECK(current() == Texts{});
    CHECK_FALSE(log->plc_error());
}

TEST_CASE_METHOD(EventWorld, "A configuration that cannot be used stands until a restart")
{
    const auto refuse = [&](std::string why) {
        return happen(
            Happening{RecordKind::ConfigurationRefused, {text("Reason", std::move(why))}}.with(
                status::Bad_ConfigurationError));
    };
    CHECK(refuse("no TOML") == Texts{"00000004 no TOML"});
    happen(RecordKind::ServerRunning);
    CHECK(current() == Texts{"00000004 no TOML"});
    happen(RecordKind::ServerStarted);
    CHECK(current() == Texts{});
    refuse("no program");
    CHECK(happen(RecordKind::ConfigurationRefused) == Texts{}); // it is used
    CHECK(current() == Texts{});
}

TEST_CASE_METHOD(EventWorld, "The highest level and code of the current errors (9-1-1)")
{
    CHECK_FALSE(log->plc_error());
    happen(RecordKind::CertificateHostNotNamed, sample_client());
    CHECK_FALSE(log->plc_error());
    happen(Happening{RecordKind::ExecutionLogLost, {{"Code", Variant{std::uint16_t{1}}}}});
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x15000000});
    happen(RecordKind::ServerSystemError);
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x44180000});
    happen(RecordKind::CertificateExpired, sample_client());
    CHECK(log->plc_error() == PlcError{EventLevel::MinorFault, 0x44180000});
    CHECK(log->current_errors().size() == 4);
}

} // namespace machine_event_log_test
