#include <map>

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <set>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_event_raiser.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

class StandingClock final : public WallClock {
public:
    DateTime now() const override { return time; }

    DateTime time{example_start};
};

/// "35D40000 21,x": code and what is attached.
std::string short_event(const MachineEvent& event)
{
    std::string text = code_text(*event.type);
    for (const std::string& each : event.attached) {
        text += (each == event.attached.front() ? " " : ",") + each;
    }
    return text;
}

using Texts = std::vector<std::string>;

Texts short_events(const std::vector<MachineEvent>& events)
{
    Texts texts;
    for (const MachineEvent& each : events) {
        texts.push_back(short_event(each));
    }
    return texts;
}

class EventEar final : public MachineEventListener {
public:
    void happened(const MachineEvent& event) override { heard.push_back(short_event(event)); }

    Texts heard;
};

struct EventWorld {
    explicit EventWorld(MachineEventLogOptions its_options = {}) : options{std::move(its_options)}
    {
        restart();
    }

    void restart()
    {
        log.reset();
        log = MachineEventLog::create(storage, clock, next, &ear, options).value();
    }
    /// What comes of it.
    Texts happen(const Happening& happening)
    {
        ear.heard.clear();
        log->record(happening.record());
        return ear.heard;
    }
    Texts happen(RecordKind kind) { return happen(Happening{kind}); }
    Texts happen(RecordKind kind, const crypto::Certificate& certificate)
    {
        Happening happening{kind};
        happening.of(certificate.der());
        return happen(happening);
    }
    [[nodiscard]] Texts current() const { return short_events(log->current_errors()); }
    /// As many as told, numbered.
    void refuse(int from, int count)
    {
        for (int i = from; i < from + count; ++i) {
            happen(Happening{RecordKind::LoginRefused}
                       .by("user" + std::to_string(i))
                       .with(status::Bad_UserAccessDenied));
        }
    }

    storage::MemoryStorage storage;
    StandingClock clock;
    NullLog next;
    EventEar ear;
    MachineEventLogOptions options;
    std::unique_ptr<MachineEventLog> log;
};

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
    CHECK(machine_event_types().size() == rows.size() + 1);
    std::set<std::string_view> names;
    for (const MachineEventType& type : machine_event_types()) {
        CHECK(names.insert(type.name).second);
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
    restart();
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
        for (std::size_t steps = 0; !is_through; ++steps) {
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
                              "8\t2017-10-17T14:52:50Z\t00000001\tInformation\r\n"
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
