#include <catch2/catch.hpp>

#include <map>
#include <optional>

#include <busbar/harness/jumping_clock.hpp>

#include "controller/life/logged_life.hpp"
#include "controller/publishing/program_parts.hpp"
#include "virtual_machine.hpp"

namespace machine_day_test {

// What a day of a controller leaves in its logs.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

using controller::test::array_of;
using controller::test::numbered;
using controller::test::structure;
using controller::test::use;
using controller::test::variable;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr const char* machine_address = "192.168.250.1";

Program with_counter(std::vector<GlobalVariable> others)
{
    Program program;
    program.variables = {variable("Counter")};
    program.variables[0].is_retained = true;
    program.variables.insert(program.variables.end(), others.begin(), others.end());
    return program;
}

Program first_program()
{
    Program program = with_counter({variable("Odd", array_of(use(ElementaryType::Int), {{1, 2}})),
                                    variable("Saw", use("Axis"))});
    program.types = {structure("Axis", {use(ElementaryType::Int), use(ElementaryType::Int)})};
    return program;
}

Program day_program()
{
    return with_counter({variable("Speed")});
}

ServerSettings settings_with(std::uint32_t port)
{
    return {.is_used = true, .port = port, .execution_log = {true, 3, 100}};
}

DateTime at_time(Duration since_midnight)
{
    return {harness::first_day.ticks + since_midnight.count() / 100};
}

/// A day from midnight to midnight, and what is done in it.
class Day {
public:
    Day();
    void live();

    storage::MemoryStorage memory;
    storage::MemoryStorage card;

private:
    void at(Duration time, std::function<void(VirtualMachine&)> what);
    void switch_on();
    void work_each_second();

    void programs_and_addresses();
    void cards();
    void people();
    void restore_and_end();

    harness::Scheduler scheduler_;
    harness::JumpingClock clock_{scheduler_};
    std::optional<VirtualMachine> machine_;
    std::vector<std::byte> backup_;
    std::optional<OpcuaShutdown> instruction_;
};

Day::Day()
{
    // The server's certificate ends in the day, and so does that of a client.
    const crypto::OwnCertificateStore store{memory};
    const auto own = certificate_of(std::string{"NxOpcUaServer@"} + machine_address,
                                    at_time(hours{15} - hours{24 * 31}), 31);
    REQUIRE(store.install({{own}, test_key()}, own.application_uri()));
    const auto client = certificate_of("Line 4", at_time(hours{12} - hours{24 * 100}), 100);
    REQUIRE(memory.make_folder("trusted/certs", FileAccess::Everyone));
    REQUIRE(memory.replace("trusted/certs/line4.der", client.der(), FileAccess::Everyone));
    MachineSettings settings{memory, "server.json", "security.json", "transaction"};
    REQUIRE(settings.transfer(settings_with(4'840), MachineMode::Program));
}

void Day::at(Duration time, std::function<void(VirtualMachine&)> what)
{
    scheduler_.at(TimePoint{time}, [this, what = std::move(what)] {
        REQUIRE(machine_);
        what(*machine_);
    });
}

void Day::switch_on()
{
    machine_.emplace(memory, card, clock_, [this](Duration delay, std::function<void()> what) {
        scheduler_.after(delay, std::move(what));
    });
    machine_->program = first_program();
    machine_->power_on();
    work_each_second();
}

void Day::work_each_second()
{
    if (machine_) {
        machine_->work();
        scheduler_.after(seconds{1}, [this] { work_each_second(); });
    }
}

void Day::programs_and_addresses()
{
    at(hours{7} + minutes{30},
       [](VirtualMachine& machine) { machine.download(day_program(), settings_with(4'850)); });
    at(hours{8} + minutes{15},
       [](VirtualMachine& machine) { machine.edit_online(variable("Late")); });
    at(hours{9}, [](VirtualMachine& machine) { machine.change_address("192.168.250.2"); });
    at(hours{9} + minutes{10},
       [](VirtualMachine& machine) { machine.change_address(machine_address); });
}

void Day::cards()
{
    // As the manual has it (7-4-3): nothing is lost, nobody is told.
    at(hours{10}, [this](VirtualMachine& machine) {
        machine.release_card();
        machine.card_is_in(false);
        card.set_away(true);
    });
    at(hours{10} + minutes{5},
       [](VirtualMachine& machine) { tell(*machine.execution_log, refused_client().record()); });
    at(hours{10} + minutes{20}, [this](VirtualMachine& machine) {
        card.set_away(false);
        machine.card_is_in(true);
    });
    // Pulled by somebody who does not know that, while a large project comes.
    at(hours{11}, [this](VirtualMachine&) { card.set_away(true); });
    at(hours{11} + minutes{5}, [](VirtualMachine& machine) {
        machine.download(with_counter(numbered(90)), settings_with(4'850));
    });
    at(hours{11} + minutes{20}, [this](VirtualMachine& machine) {
        CHECK(machine.event_log->plc_error() == PlcError{EventLevel::MinorFault, 0x15000000});
        card.set_away(false);
    });
    at(hours{11} + minutes{30}, [](VirtualMachine& machine) {
        CHECK_FALSE(machine.event_log->plc_error());
        machine.download(day_program(), settings_with(4'850));
    });
}

void Day::people()
{
    at(hours{13}, [](VirtualMachine& machine) {
        machine.life.mode_changed(MachineMode::Run);
        const auto refused = machine.settings.transfer(settings_with(5'000), machine.life.mode());
        REQUIRE_FALSE(refused);
        CHECK(refused.error().status == status::Bad_InvalidState);
    });
    at(hours{13} + minutes{30},
       [](VirtualMachine& machine) { machine.life.mode_changed(MachineMode::Program); });
    at(hours{14}, [this](VirtualMachine& machine) {
        backup_ = machine.data.backup({"press 4", clock_.now()}).value();
        CHECK(machine.life.operating_status() == OperatingStatus::Running);
        REQUIRE(machine.scan(20));
    });
    at(hours{14} + minutes{30},
       [this](VirtualMachine&) { REQUIRE(memory.remove("trusted/certs/line4.der")); });
    at(hours{15} + minutes{30}, [](VirtualMachine& machine) {
        CHECK(machine.event_log->plc_error() == PlcError{EventLevel::MinorFault, 0x35D10000});
        machine.renew_certificate(365);
        CHECK_FALSE(machine.event_log->plc_error());
    });
}

void Day::restore_and_end()
{
    at(hours{16},
       [](VirtualMachine& machine) { machine.download(day_program(), settings_with(4'860)); });
    at(hours{17}, [this](VirtualMachine& machine) {
        REQUIRE(machine.restore(backup_));
        CHECK(machine.life.is_restart_due());
        CHECK_FALSE(machine.is_open);
    });
    at(hours{17} + minutes{5}, [](VirtualMachine& machine) {
        CHECK(machine.life.operating_status() == OperatingStatus::Shutdown);
        machine.life.reset();
    });
    at(hours{18}, [this](VirtualMachine& machine) {
        CHECK(machine.is_open);
        CHECK(machine.life.status({}).end_point == "opc.tcp://192.168.250.1:4850");
        CHECK(machine.counter() == 20);
        CHECK(memory.entry("trusted/certs/line4.der"));
    });
    at(hours{20}, [this](VirtualMachine& machine) {
        instruction_.emplace(machine.desk);
        (*instruction_)(true);
    });
    at(hours{20} + minutes{1}, [this](VirtualMachine&) {
        (*instruction_)(true);
        CHECK(instruction_->done());
        instruction_.reset();
        machine_.reset();
    });
}

void Day::live()
{
    scheduler_.at(TimePoint{hours{6}}, [this] { switch_on(); });
    programs_and_addresses();
    cards();
    people();
    restore_and_end();
    scheduler_.run_until(TimePoint{hours{24}});
}

/// "06:00:02 SERVER 0005 Run".
Texts timed_lines(const ExecutionLogContents& contents)
{
    Texts lines = lines_of(contents);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string time = execution_log_columns(contents.entries[i])[1];
        CHECK(time.starts_with("2026/01/01/"));
        lines[i] = time.substr(11, 8) + " " + lines[i];
    }
    return lines;
}

/// "11:05:01 15000000 Minor fault 0001".
Texts timed_events(const std::vector<MachineEvent>& events)
{
    Texts lines;
    for (const MachineEvent& each : events) {
        std::string line = to_string(each.time).substr(11, 8) + " " + code_text(*each.type) + " " +
                           std::string{name(each.level)};
        for (const std::string& attached : each.attached) {
            line += " " + attached;
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

/// Of the program with ninety more variables.
Texts large_preparation()
{
    Texts lines{"11:05:02 SERVER 0111 PublishedVariable Counter 2Byte 1 0"};
    for (const GlobalVariable& each : numbered(90)) {
        lines.push_back("11:05:02 SERVER 0111 PublishedVariable " + each.name + " 2Byte 1 0");
    }
    lines.emplace_back("11:05:02 SERVER 0110 NumOfVariables Variables=91, Values=91, DataTypes=0");
    return lines;
}

/// Of the day's program; with what was added online until it was downloaded again.
Texts day_preparation(const std::string& begin, const std::string& end, bool has_late)
{
    Texts lines{begin + " SERVER 0004 Prepare",
                end + " SERVER 0111 PublishedVariable Counter 2Byte 1 0"};
    if (has_late) {
        lines.push_back(end + " SERVER 0111 PublishedVariable Late 2Byte 1 0");
    }
    const std::string count = has_late ? "3" : "2";
    lines.push_back(end + " SERVER 0111 PublishedVariable Speed 2Byte 1 0");
    lines.push_back(end + " SERVER 0110 NumOfVariables Variables=" + count + ", Values=" + count +
                    ", DataTypes=0");
    lines.push_back(end + " SERVER 0005 Run");
    return lines;
}

Texts expected_day()
{
    Texts all;
    const auto add = [&](const Texts& lines) { all.insert(all.end(), lines.begin(), lines.end()); };
    const std::string own_name = " NxOpcUaServer@192.168.250.1 2026-01-01T15:00:00Z";
    add({"06:00:00 SERVER 0001 Start", "06:00:00 SERVER 0004 Prepare",
         "06:00:00 CERT 0002 Notify_Server" + own_name,
         "06:00:02 SERVER 0111 PublishedVariable Counter 2Byte 1 0",
         "06:00:02 SERVER 0101 InvalidDataType Odd SubscriptOfArray",
         "06:00:02 SERVER 0111 PublishedVariable Saw 4Byte 2 2",
         "06:00:02 SERVER 0110 NumOfVariables Variables=2, Values=3, DataTypes=1",
         "06:00:02 SERVER 0005 Run"});
    add(day_preparation("07:30:00", "07:30:02", false));
    add({"08:15:00 SERVER 0111 PublishedVariable Late 2Byte 1 0",
         "08:15:00 SERVER 0110 NumOfVariables Variables=3, Values=3, DataTypes=0"});
    Texts moved = day_preparation("09:00:00", "09:00:02", true);
    moved.insert(moved.begin() + 1, "09:00:00 CERT 0004 Mismatch_Host" + own_name);
    add(moved);
    add(day_preparation("09:10:00", "09:10:02", true));
    add({"10:05:00 AUTH 0001 Application ERROR BadCertificateUntrusted"});
    add({"11:05:00 SERVER 0004 Prepare"});
    add(large_preparation());
    add({"11:05:02 SERVER 0005 Run"});
    add(day_preparation("11:30:00", "11:30:02", false));
    const std::string client_expired =
        " CERT 0104 Expired_Client Line 4 2026-01-01T12:00:00Z CLIENT TRUSTED";
    add({"12:00:01" + client_expired, "15:00:01 CERT 0003 Expired_Server" + own_name,
         "15:30:00 CERT 0001 Update_Server NxOpcUaServer@192.168.250.1 2027-01-01T15:30:00Z"});
    add(day_preparation("15:30:00", "15:30:02", false));
    add(day_preparation("16:00:00", "16:00:02", false));
    add({"17:00:00 SERVER 0006 Shutdown", "17:05:00 SERVER 0001 Start"});
    Texts again = day_preparation("17:05:00", "17:05:02", false);
    again.insert(again.begin() + 1, "17:05:00" + client_expired);
    add(again);
    add({"20:00:00 SERVER 0006 Shutdown"});
    return all;
}

/// The bytes of all files of a medium that begin so.
std::map<std::string, std::vector<std::byte>> files_of(storage::MemoryStorage& medium,
                                                       std::string_view prefix)
{
    std::map<std::string, std::vector<std::byte>> files;
    for (const std::string& name : medium.names()) {
        if (const auto bytes = read_file(medium, name, 1U << 20U);
            bytes && name.starts_with(prefix)) {
            files[name] = *bytes;
        }
    }
    return files;
}

} // namespace

TEST_CASE("A day of a machine in its execution log, record by record (7-1-1)")
{
    Day day;
    day.live();
    const auto contents =
        read_execution_log(day.card, ExecutionLogOptions{}.folder, {}, 1'000).value();
    CHECK_FALSE(contents.is_cut);
    const Texts expected = expected_day();
    const Texts found = timed_lines(contents);
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(found[i] == expected[i]);
        CHECK(contents.entries[i].serial_number == i);
    }
    // The hundredth record came when the card with the large project's records was back.
    CHECK(day.card.names() ==
          Texts{"packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log",
                "packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog_20260101112000000.log",
                "packages/OPCUA_Server/System/OPCUA_ExecutionLog.fjc"});
}

TEST_CASE("A day of a machine in its event log, event by event (9-2-2)")
{
    Day day;
    day.live();
    harness::Scheduler scheduler;
    const harness::JumpingClock clock{scheduler};
    NullLog lines;
    const auto log = MachineEventLog::create(day.memory, clock, lines).value();
    REQUIRE(log->load());
    CHECK(
        timed_events(log->events()) ==
        Texts{"06:00:00 95D00000 Information", "06:00:00 35D20000 Observation 2026-01-01 15:00:00",
              "06:00:02 35D40000 Observation 10", "09:00:00 15020000 Observation 192.168.250.1",
              "10:05:00 85600000 Observation 02", "11:05:00 15000000 Minor fault 0001",
              "12:00:01 00000000 Observation Line 4 2026-01-01 12:00:00",
              "15:00:01 35D10000 Minor fault 2026-01-01 15:00:00", "15:30:00 95D20000 Information",
              "17:00:00 95D10000 Information", "17:05:00 95D00000 Information",
              "17:05:00 00000000 Observation Line 4 2026-01-01 12:00:00",
              "20:00:00 95D10000 Information"});
}

TEST_CASE("The same day leaves the same bytes (7-1-5)")
{
    Day first;
    first.live();
    Day second;
    second.live();
    CHECK(files_of(first.card, "") == files_of(second.card, ""));
    CHECK(files_of(first.memory, "events/") == files_of(second.memory, "events/"));
    CHECK(files_of(first.card, "").size() == 3);
    CHECK(files_of(first.memory, "events/").size() == 1);
}

} // namespace machine_day_test
