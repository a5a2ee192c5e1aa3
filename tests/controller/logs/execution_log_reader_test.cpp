#include <catch2/catch.hpp>

#include <busbar/controller/execution_log_reader.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

namespace execution_log_reader_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

/// Of 7-1-7, some of each category.
const std::string sample_log =
    "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart\r\n"
    "2\t2017-10-17\t14:52:50\t877\tSERVER\t0111\tPublishedVariable\tVar1\t2Byte\t1\t0\r\n"
    "8\t2017-10-17\t14:54:11\t822\tAUTH\t0001\tApplication\tERROR\tBadCertificateUntrusted\r\n"
    "9\t2017-10-17\t14:54:11\t844\tCERT\t0103\tDiscard\tUaClient_1@SamplePC\t"
    "2022-10-03T08:19:54Z\tCLIENT\tREJECTED\r\n";

std::vector<int> serials_of(const ExecutionLogContents& contents)
{
    std::vector<int> serials;
    for (const ExecutionLogEntry& each : contents.entries) {
        serials.push_back(each.serial_number);
    }
    return serials;
}

std::vector<int> found_by(const ExecutionLogFilter& filter)
{
    return serials_of(read_execution_log(sample_log, filter, 100));
}

using Serials = std::vector<int>;

void set_log(Storage& storage, const std::string& name, std::string_view text)
{
    REQUIRE(storage.make_folder("log", FileAccess::Everyone));
    REQUIRE(storage.replace("log/" + name, std::as_bytes(std::span{text}), FileAccess::Everyone));
}

} // namespace

TEST_CASE("What was written is read again, of each code (7-1-6)")
{
    for (const ExecutionLogCode& code : execution_log_codes()) {
        for (const std::string details : {"", "a", "a\tb\t\xC3\xA4\tc", "\t\t"}) {
            const ExecutionLogItem item{&code, details};
            std::string line = execution_log_record(65'535, example_start, {}, item);
            line.resize(line.size() - 2);
            const auto entry = parse_execution_log_record(line);
            INFO(line);
            REQUIRE(entry);
            CHECK(entry->serial_number == 65'535);
            CHECK(entry->time == example_start);
            CHECK(entry->code == &code);
            CHECK(entry->details == details);
        }
    }
}

TEST_CASE("Lines of another form are no records (7-1-6)")
{
    const std::string good = "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart";
    REQUIRE(parse_execution_log_record(good));
    for (const std::string bad : {"", "0", "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStar",
                                  "65536\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart",
                                  "-1\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart",
                                  "0\t2017-10-32\t14:52:50\t747\tSERVER\t0001\tStart",
                                  "0\t2017-10-17\t24:52:50\t747\tSERVER\t0001\tStart",
                                  "0\t2017-10-17\t14:52:50\t74\tSERVER\t0001\tStart",
                                  "0\t2017-10-17\t14:52:50\t747\tSERVER\t1\tStart",
                                  "0\t2017-10-17\t14:52:50\t747\tAUTH\t0001\tStart",
                                  "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart\ta\x01",
                                  "0\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart\t\xFF"}) {
        INFO(bad);
        CHECK_FALSE(parse_execution_log_record(bad));
    }
    CHECK(parse_execution_log_record(good + "\t" + std::string(168, 'd')));
    CHECK_FALSE(parse_execution_log_record(good + "\t" + std::string(169, 'd')));
    CHECK_FALSE(parse_execution_log_record(good + "\t" + std::string(10'000, 'd')));
}

TEST_CASE("A log is searched by category, code, time and text (7-2-2)")
{
    CHECK(found_by({}) == Serials{0, 2, 8, 9});
    CHECK(found_by({.category = "AUTH"}) == Serials{8});
    CHECK(found_by({.category = "NONE"}) == Serials{});
    CHECK(found_by({.code = 1}) == Serials{0, 8});
    CHECK(found_by({.category = "SERVER", .code = 1}) == Serials{0});
    CHECK(found_by({.from = later(example_start, 130)}) == Serials{2, 8, 9});
    CHECK(found_by({.to = later(example_start, 130)}) == Serials{0});
    CHECK(found_by({.text = "samplepc"}) == Serials{9});
    CHECK(found_by({.text = "APPLICATION"}) == Serials{8});
    CHECK(found_by({.category = "SERVER", .text = "samplepc"}) == Serials{});
}

TEST_CASE("The columns in which people see a log (7-2-2)")
{
    CHECK(execution_log_column_names == std::array<std::string_view, 6>{"Entry", "Date/Time",
                                                                        "Category", "Log Code",
                                                                        "Log Name", "Details"});
    const auto entries = read_execution_log(sample_log, {.code = 111}, 1).entries;
    REQUIRE(entries.size() == 1);
    CHECK(execution_log_columns(entries[0]) ==
          std::array<std::string, 6>{"2", "2017/10/17/14:52:50.877", "SERVER", "0111",
                                     "PublishedVariable", "Var1 2Byte 1 0"});
}

TEST_CASE("The last entries are read, and what is damaged is counted (7-2-2)")
{
    const auto last = read_execution_log(sample_log, {}, 2);
    CHECK(serials_of(last) == Serials{8, 9});
    CHECK(last.is_cut);
    CHECK_FALSE(read_execution_log(sample_log, {}, 4).is_cut);
    CHECK(serials_of(read_execution_log(sample_log, {}, 0)).empty());

    const auto damaged =
        read_execution_log("x\r\n\r\n" + sample_log + "\n" + std::string(70'000, 'y') + "\r\n" +
                               "10\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tSta",
                           {}, 100);
    CHECK(serials_of(damaged) == Serials{0, 2, 8, 9});
    CHECK(damaged.damaged == 4);
    CHECK(read_execution_log("", {}, 100).damaged == 0);
    CHECK(read_execution_log("no end", {}, 100).damaged == 0);
}

TEST_CASE("All files of a folder are one log, the oldest first (7-2-1)")
{
    storage::MemoryStorage storage;
    const auto none = read_execution_log(storage, "log", {}, 100);
    REQUIRE(none);
    CHECK(none->entries.empty());

    const auto line = [](int serial) {
        return std::to_string(serial) + "\t2017-10-17\t14:52:50\t747\tSERVER\t0001\tStart\r\n";
    };
    set_log(storage, "OPCUA_ExecutionLog.log", line(5) + line(6));
    set_log(storage, "OPCUA_ExecutionLog_20171017145250750.log", line(3) + "bad\r\n" + line(4));
    set_log(storage, "OPCUA_ExecutionLog_20171017145250749.log", line(1) + line(2));
    set_log(storage, "notes.log", line(77));
    const auto all = read_execution_log(storage, "log", {}, 100);
    REQUIRE(all);
    CHECK(serials_of(*all) == Serials{1, 2, 3, 4, 5, 6});
    CHECK(all->damaged == 1);
    CHECK_FALSE(all->is_cut);
    const auto some = read_execution_log(storage, "log", {}, 3);
    REQUIRE(some);
    CHECK(serials_of(*some) == Serials{4, 5, 6});
    CHECK(some->is_cut);
    storage.set_away(true);
    CHECK(read_execution_log(storage, "log", {}, 3).error() == StorageError::Away);
}

} // namespace execution_log_reader_test
