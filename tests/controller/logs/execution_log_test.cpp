#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>

#include <busbar/controller/execution_log.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

const std::string log_folder = "packages/OPCUA_Server/ExecutionLog/";
const std::string log_file = log_folder + "OPCUA_ExecutionLog.log";
const std::string control_file = "packages/OPCUA_Server/System/OPCUA_ExecutionLog.fjc";

class MovingClock final : public WallClock {
public:
    DateTime now() const override { return time; }
    TimeZone time_zone() const override { return zone; }

    DateTime time{example_start};
    TimeZone zone;
};

/// What the log itself tells.
class Ear final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view line) override { lines += line; }
    bool wants(RecordKind kind) const override
    {
        return kind == RecordKind::ExecutionLogLost || kind == RecordKind::ExecutionLogSaved;
    }
    void record(const Record& record) override
    {
        const Variant* const code = field(record, "Code");
        told.push_back(code == nullptr ? 0 : code->value_or(std::uint16_t{0xFFFF}));
    }

    std::string lines;
    std::vector<std::uint16_t> told; // codes; 0 is "saved again"
};

struct LogWorld {
    explicit LogWorld(ExecutionLogOptions its_options = {.max_records = 100})
        : options{std::move(its_options)}
    {
        restart();
    }

    void restart()
    {
        log.reset();
        log = ExecutionLog::create(medium, clock, ear, options).value();
    }
    /// A line each; the name says which.
    void happen(const std::string& name) { log->record(published(name, 2, 1, 0).record()); }
    void happen(int from, int count)
    {
        for (int i = from; i < from + count; ++i) {
            happen("v" + std::to_string(i));
        }
    }
    [[nodiscard]] std::string file(const std::string& name = log_file)
    {
        const auto bytes = read_file(medium, name, 1U << 24U);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{};
    }
    /// "0 v0", "1 v1": serial numbers and names in all files; "?" for a line of another form.
    [[nodiscard]] std::vector<std::string> all_lines();
    [[nodiscard]] std::vector<std::string> log_files()
    {
        std::vector<std::string> names;
        for (const std::string& name : medium.names()) {
            if (name.starts_with(log_folder)) {
                names.push_back(name.substr(log_folder.size()));
            }
        }
        return names;
    }
    void set_file(const std::string& name, std::string_view text)
    {
        REQUIRE(medium.make_folder(name.substr(0, name.rfind('/')), FileAccess::Everyone));
        REQUIRE(medium.replace(name, std::as_bytes(std::span{text}), FileAccess::Everyone));
    }

    storage::MemoryStorage medium;
    MovingClock clock;
    Ear ear;
    ExecutionLogOptions options;
    std::unique_ptr<ExecutionLog> log;
};

std::string short_line(const std::string& line)
{
    std::vector<std::string> columns{""};
    for (const char c : line) {
        if (c == '\t') {
            columns.emplace_back();
        } else {
            columns.back() += c;
        }
    }
    return columns.size() == 11 && columns[6] == "PublishedVariable" ? columns[0] + " " + columns[7]
                                                                     : "?";
}

std::vector<std::string> LogWorld::all_lines()
{
    std::string text;
    for (const std::string& name : log_files()) { // the current one is the first by name
        if (name != "OPCUA_ExecutionLog.log") {
            text += file(log_folder + name);
        }
    }
    text += file();
    std::vector<std::string> lines;
    for (std::size_t end = 0; (end = text.find("\r\n")) != std::string::npos;) {
        lines.push_back(short_line(text.substr(0, end)));
        text.erase(0, end + 2);
    }
    if (!text.empty()) {
        lines.push_back("?");
    }
    return lines;
}

std::vector<std::string> expected_lines(int count)
{
    std::vector<std::string> lines;
    for (int i = 0; i < count; ++i) {
        lines.push_back(std::to_string(i) + " v" + std::to_string(i));
    }
    return lines;
}

std::string line_of(int serial)
{
    return std::to_string(serial) +
           "\t2017-10-17\t14:52:50\t747\tSERVER\t0111\tPublishedVariable\tv\t2Byte\t1\t0\r\n";
}

} // namespace

TEST_CASE_METHOD(LogWorld, "Records wait in memory and are saved in their file (7-1-1)")
{
    happen("v0");
    CHECK(log->waiting() == 1);
    CHECK(medium.steps() == 0);
    CHECK(medium.reads() == 0);
    REQUIRE(log->write_pending());
    CHECK(log->waiting() == 0);
    CHECK(file() == "0\t2017-10-17\t14:52:50\t747\tSERVER\t0111\tPublishedVariable\tv0\t2Byte\t1"
                    "\t0\r\n");
    CHECK(ear.told.empty());
    log->write(LogLevel::Info, "x", "goes on");
    CHECK(ear.lines == "goes on");
}

TEST_CASE("Numbers of files and records have ranges (7-1-3)")
{
    storage::MemoryStorage medium;
    MovingClock clock;
    NullLog next;
    const auto where = [&](ExecutionLogOptions options) {
        const auto log = ExecutionLog::create(medium, clock, next, std::move(options));
        return log ? "" : log.error().where;
    };
    CHECK(where({}) == "");
    CHECK(ExecutionLogOptions{}.max_files == 24);
    CHECK(ExecutionLogOptions{}.max_records == 12'000);
    CHECK(where({.max_files = 2}) == "");
    CHECK(where({.max_files = 100}) == "");
    CHECK(where({.max_files = 1}) == "max_files");
    CHECK(where({.max_files = 101}) == "max_files");
    CHECK(where({.max_records = 100}) == "");
    CHECK(where({.max_records = 65'536}) == "");
    CHECK(where({.max_records = 99}) == "max_records");
    CHECK(where({.max_records = 65'537}) == "max_records");
    CHECK(where({.max_waiting = 599}) == "max_waiting");
    CHECK(where({.folder = "../x"}) == "folder");
}

TEST_CASE_METHOD(LogWorld, "A full file is named by the time and a new one begun (7-1-5)")
{
    happen(0, 100);
    clock.time = later(example_start, 1'234);
    clock.zone.offset = 60;
    REQUIRE(log->write_pending());
    CHECK(log_files() == std::vector<std::string>{"OPCUA_ExecutionLog.log"});
    happen(100, 1);
    REQUIRE(log->write_pending());
    CHECK(log_files() == std::vector<std::string>{"OPCUA_ExecutionLog.log",
                                                  "OPCUA_ExecutionLog_20171017155251981.log"});
    CHECK(all_lines() == expected_lines(101));
    // At the same time, as with a clock that was set back: no file is lost.
    happen(101, 200);
    REQUIRE(log->write_pending());
    CHECK(log_files() == std::vector<std::string>{"OPCUA_ExecutionLog.log",
                                                  "OPCUA_ExecutionLog_20171017155251981.log",
                                                  "OPCUA_ExecutionLog_20171017155251982.log",
                                                  "OPCUA_ExecutionLog_20171017155251983.log"});
    CHECK(all_lines() == expected_lines(301));
}

TEST_CASE("The oldest file goes when there are as many as may be (7-1-3)")
{
    LogWorld world{{.max_files = 3, .max_records = 100}};
    world.set_file(log_folder + "OPCUA_ExecutionLog_other.log", "kept");
    world.happen(0, 450);
    REQUIRE(world.log->write_pending());
    CHECK(world.log_files() == std::vector<std::string>{"OPCUA_ExecutionLog.log",
                                                        "OPCUA_ExecutionLog_20171017145250749.log",
                                                        "OPCUA_ExecutionLog_20171017145250750.log",
                                                        "OPCUA_ExecutionLog_other.log"});
    CHECK(world.file().starts_with("400\t"));
    CHECK(world.file(log_folder + "OPCUA_ExecutionLog_20171017145250749.log").starts_with("200\t"));
}

TEST_CASE_METHOD(LogWorld, "Files of a name that cannot be ours do not stop the log (7-1-5)")
{
    for (const std::string digits :
         {"99999999999999999", "99991231235959999", "20171399999999999"}) {
        set_file(log_folder + "OPCUA_ExecutionLog_" + digits + ".log", "kept");
    }
    // One of a clock that went ahead: what is written later comes behind it.
    set_file(log_folder + "OPCUA_ExecutionLog_20991231235959999.log", line_of(41));
    happen(0, 250);
    REQUIRE(log->write_pending());
    CHECK(file().starts_with("242\t"));
    CHECK(log_files().size() == 7);
    CHECK(file(log_folder + "OPCUA_ExecutionLog_21000101000000001.log").starts_with("142\t"));
}

TEST_CASE_METHOD(LogWorld, "Serial numbers go on over files and restarts, and round (7-1-6)")
{
    set_file(log_file, line_of(65'533));
    happen(0, 2);
    REQUIRE(log->write_pending());
    restart();
    happen(2, 2);
    REQUIRE(log->write_pending());
    CHECK(all_lines() ==
          std::vector<std::string>{"65533 v", "65534 v0", "65535 v1", "0 v2", "1 v3"});
}

TEST_CASE_METHOD(LogWorld,
                 "The serial number is found without the log file or control file (7-1-5)")
{
    happen(0, 120);
    REQUIRE(log->flush());
    CHECK(file(control_file) == "busbar execution log 1\r\nnext 120\r\nrecords 20\r\n");

    SECTION("the control file is lost")
    {
        REQUIRE(medium.remove(control_file));
    }
    SECTION("the control file is wrong")
    {
        set_file(control_file, "busbar execution log 1\r\nnext 7\r\n");
    }
    SECTION("the latest log file is lost")
    {
        REQUIRE(medium.remove(log_file));
    }
    SECTION("both are lost")
    {
        REQUIRE(medium.remove(log_file));
        REQUIRE(medium.remove(control_file));
        restart();
        happen("next");
        REQUIRE(log->write_pending());
        CHECK(all_lines().back() == "100 next");
        return;
    }
    SECTION("nothing is left but the control file")
    {
        REQUIRE(log->clear());
        CHECK(log_files().empty());
    }
    restart();
    happen("next");
    REQUIRE(log->write_pending());
    CHECK(all_lines().back() == "120 next");
}

TEST_CASE_METHOD(LogWorld, "A log file that somebody deletes is made anew (7-1-5)")
{
    happen(0, 3);
    REQUIRE(log->write_pending());
    REQUIRE(medium.remove(log_file));
    happen(3, 1);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == std::vector<std::string>{"3 v3"});
    // The folder too.
    REQUIRE(medium.remove(log_file));
    REQUIRE(medium.remove(log_folder.substr(0, log_folder.size() - 1)));
    happen(4, 1);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == std::vector<std::string>{"4 v4"});
    CHECK(ear.told.empty());
}

TEST_CASE_METHOD(LogWorld, "A file too large for the log is put aside (7-1-5)")
{
    set_file(log_file, std::string(400'000, 'x'));
    happen(0, 1);
    REQUIRE(log->write_pending());
    CHECK(log_files().size() == 2);
    CHECK(file() == line_of(0).replace(line_of(0).find("\tv\t"), 3, "\tv0\t"));
}

TEST_CASE("Whatever the power cuts, lines are whole and what was saved stays (7-1-5)",
          "[power_cut][logs]")
{
    bool is_through = false;
    for (std::size_t steps = 0; !is_through; ++steps) {
        LogWorld world;
        world.happen(0, 98);
        REQUIRE(world.log->flush());
        world.medium.cut_power_after(steps);
        world.happen(98, 4); // over a file's end
        is_through = world.log->write_pending().has_value();
        const int saved = 102 - static_cast<int>(world.log->waiting());
        world.medium.restore_power();

        world.restart();
        world.happen("after");
        REQUIRE(world.log->write_pending());
        const auto lines = world.all_lines();
        INFO("power cut after " << steps << " steps, " << saved << " saved");
        REQUIRE(lines.size() > static_cast<std::size_t>(saved));
        auto expected = expected_lines(static_cast<int>(lines.size()) - 1);
        expected.push_back(std::to_string(lines.size() - 1) + " after");
        REQUIRE(lines == expected);
    }
}

TEST_CASE("Whatever fails on the medium, each record is saved once (7-1-1)", "[power_cut][logs]")
{
    for (const StorageError error :
         {StorageError::Away, StorageError::Full, StorageError::Protected, StorageError::Failed}) {
        bool is_through = false;
        for (std::size_t steps = 0; !is_through; ++steps) {
            LogWorld world;
            world.happen(0, 98);
            REQUIRE(world.log->write_pending());
            world.medium.fail_once_after(steps, error);
            world.happen(98, 4);
            is_through = world.log->write_pending().has_value();
            world.medium.restore_power();
            REQUIRE(world.log->write_pending());
            INFO(text(error) << " after " << steps << " steps");
            REQUIRE(world.all_lines() == expected_lines(102));
            REQUIRE(world.ear.told.size() == (is_through ? 0 : 2));
            REQUIRE(world.log->lost() == 0);
        }
    }
}

TEST_CASE_METHOD(LogWorld,
                 "A line that was cut is cut off, or ended where there is no room (7-1-5)")
{
    set_file(log_file, line_of(0) + "1\t2017-10-17\t14:5");
    SECTION("cut off")
    {
        happen("v1");
        REQUIRE(log->write_pending());
        CHECK(all_lines() == std::vector<std::string>{"0 v", "1 v1"});
    }
    SECTION("ended")
    {
        happen("v1");
        medium.fail_once_after(0, StorageError::Full);
        REQUIRE(log->write_pending());
        CHECK(all_lines() == std::vector<std::string>{"0 v", "?", "1 v1"});
        CHECK(ear.told.empty());
    }
}

TEST_CASE("Why records are not saved is told once, and that they are again (9-2-2, 15000000)",
          "[power_cut][logs]")
{
    LogWorld world;
    const auto fail_by = [&](auto set, std::uint16_t code) {
        world.ear.told.clear();
        set(true);
        world.happen("v");
        CHECK_FALSE(world.log->write_pending());
        CHECK_FALSE(world.log->write_pending());
        CHECK(world.ear.told == std::vector<std::uint16_t>{code});
        CHECK(world.log->waiting() == 1);
        set(false);
        CHECK(world.log->write_pending());
        CHECK(world.ear.told == std::vector<std::uint16_t>{code, 0});
        CHECK(world.log->waiting() == 0);
        CHECK(world.log->write_pending());
        CHECK(world.ear.told.size() == 2);
    };
    auto& medium = world.medium;
    fail_by([&](bool is_on) { medium.set_away(is_on); }, 0x0001);
    fail_by([&](bool is_on) { medium.set_protected(is_on); }, 0x0003);
    fail_by([&](bool is_on) { medium.set_capacity(is_on ? 10 : UINT64_MAX); }, 0x0005);
    fail_by(
        [&](bool is_on) { world.log->medium_changed(is_on ? LogMedium::Unusable : LogMedium::In); },
        0x0002);
    world.ear.told.clear();
    medium.fail_once_after(0, StorageError::Failed);
    world.happen("v");
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0302});
}

TEST_CASE_METHOD(LogWorld, "Without a medium at the start records begin when there is one (7-4-1)")
{
    medium.set_away(true);
    happen(0, 2);
    CHECK_FALSE(log->write_pending());
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001});
    medium.set_away(false);
    log->medium_changed(LogMedium::In);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == expected_lines(2));
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001, 0});
}

TEST_CASE_METHOD(LogWorld, "While the medium is changed records wait and nothing is told (7-4-3)")
{
    happen(0, 2);
    REQUIRE(log->release_medium());
    CHECK(all_lines() == expected_lines(2));
    const std::size_t steps = medium.steps();
    happen(2, 600); // 30 seconds at one in 50 ms (7-4-4)
    CHECK_FALSE(log->write_pending());
    CHECK(medium.steps() == steps);
    CHECK(ear.told.empty());
    // Another medium, with a log of its own: numbers go on.
    set_file(log_file, line_of(7));
    log->medium_changed(LogMedium::In);
    REQUIRE(log->write_pending());
    CHECK(ear.told.empty());
    const auto lines = all_lines();
    CHECK(lines.size() == 601);
    CHECK(lines[0] == "7 v");
    CHECK(lines[1] == "2 v2");
    CHECK(lines.back() == "601 v601");
}

TEST_CASE("What there is no room for is lost and told (7-4-5)")
{
    LogWorld world{{.max_records = 100, .max_waiting = 600}};
    world.log->medium_changed(LogMedium::Out);
    world.happen(0, 600);
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told.empty());
    world.happen(600, 3);
    CHECK(world.log->lost() == 3);
    CHECK(world.ear.told.empty()); // not by the server's thread
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0001});
    world.log->medium_changed(LogMedium::In);
    REQUIRE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0001, 0});
    CHECK(world.all_lines() == expected_lines(600));
}

TEST_CASE("One whole Preparing waits by default (7-4-5)")
{
    LogWorld world{{}};
    world.log->medium_changed(LogMedium::Out);
    world.log->record(Happening{RecordKind::ServerPreparing}.record());
    world.happen(0, 10'000);
    world.log->record(Happening{RecordKind::VariablesCounted}.record());
    world.log->record(Happening{RecordKind::ServerRunning}.record());
    world.happen(10'000, 600);
    CHECK(world.log->lost() == 0);
    CHECK(world.log->waiting() == 10'603);
}

TEST_CASE_METHOD(LogWorld, "What still waits when the power goes is told as lost (7-1-1)")
{
    log->medium_changed(LogMedium::Out);
    CHECK_FALSE(log->flush());
    CHECK(ear.told.empty());
    happen("v0");
    CHECK_FALSE(log->flush());
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001});
}

TEST_CASE_METHOD(LogWorld, "The expiration of a certificate is noticed only once (7-1-1)")
{
    const auto notice = [&](RecordKind kind, const crypto::Certificate& certificate) {
        Happening happening{kind};
        happening.of(certificate.der());
        log->record(happening.record());
        return log->waiting();
    };
    const auto other = certificate_of("other", example_start, 10);
    CHECK(notice(RecordKind::CertificateExpiring, sample_client()) == 1);
    CHECK(notice(RecordKind::CertificateExpiring, sample_client()) == 1);
    CHECK(notice(RecordKind::CertificateExpired, sample_client()) == 2);
    CHECK(notice(RecordKind::CertificateExpiring, other) == 3);
    CHECK(notice(RecordKind::CertificateUpdated, other) == 4);
    CHECK(notice(RecordKind::CertificateExpiring, other) == 5);
    restart();
    CHECK(notice(RecordKind::CertificateExpiring, other) == 1);
}

TEST_CASE_METHOD(LogWorld, "The log is cleared and goes on (7-2-2)")
{
    happen(0, 250);
    REQUIRE(log->write_pending());
    CHECK(log_files().size() == 3);
    REQUIRE(log->clear());
    CHECK(log_files().empty());
    happen(250, 1);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == std::vector<std::string>{"250 v250"});
    medium.set_away(true);
    CHECK_FALSE(log->clear());
}
