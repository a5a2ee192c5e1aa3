#include <catch2/catch.hpp>

#include "execution_log_world.hpp"

namespace execution_log_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

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

TEST_CASE_METHOD(LogWorld, "What waits goes with files that are removed, numbers go on (7-1-6)")
{
    happen(0, 3);
    REQUIRE(log->write_pending());
    restart(); // without a flush: power was cut
    happen(3, 2);
    REQUIRE(log->prepare_removal());
    CHECK(log->waiting() == 0);
    REQUIRE(medium.remove(log_file));
    // Nothing else to be noted, nothing is written.
    const auto steps = medium.steps();
    REQUIRE(log->prepare_removal());
    CHECK(medium.steps() == steps);
    SECTION("by the same log") {}
    SECTION("by the one after a restart")
    {
        restart();
    }
    happen(5, 1);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == std::vector<std::string>{"5 v5"});
}

TEST_CASE_METHOD(LogWorld,
                 "A file that is completed on request leaves one for what follows (7-2-2)")
{
    happen(0, 3);
    REQUIRE(log->write_pending());
    happen(3, 2); // waits, and goes with the file
    clock.time = later(example_start, 1'234);
    REQUIRE(log->begin_new_file());
    const std::vector<std::string> both{"OPCUA_ExecutionLog.log",
                                        "OPCUA_ExecutionLog_20171017145251981.log"};
    CHECK(log_files() == both);
    CHECK(file().empty());
    CHECK_FALSE(ExecutionLog::is_complete_file(both[0]));
    CHECK(ExecutionLog::is_complete_file(both[1]));
    CHECK_FALSE(ExecutionLog::is_complete_file("other.txt"));
    // A file without records is not completed.
    REQUIRE(log->begin_new_file());
    CHECK(log_files() == both);
    SECTION("by the same log") {}
    SECTION("by the one after a restart")
    {
        restart();
    }
    happen(5, 1);
    REQUIRE(log->write_pending());
    CHECK(log_files() == both);
    CHECK(all_lines().size() == 6);
    CHECK(all_lines().back() == "5 v5");
    SECTION("with a medium that is away or protected nothing is lost")
    {
        medium.set_away(true);
        CHECK_FALSE(log->begin_new_file());
        medium.set_away(false);
        medium.set_protected(true);
        CHECK_FALSE(log->begin_new_file());
        medium.set_protected(false);
        happen(6, 1);
        REQUIRE(log->write_pending());
        CHECK(all_lines().size() == 7);
    }
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

} // namespace execution_log_test
