#pragma once

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

#include <busbar/controller/execution_log.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

namespace busbar::test {

using namespace busbar::controller;

inline const std::string log_folder = "packages/OPCUA_Server/ExecutionLog/";
inline const std::string log_file = log_folder + "OPCUA_ExecutionLog.log";
inline const std::string control_file = "packages/OPCUA_Server/System/OPCUA_ExecutionLog.fjc";

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

inline std::string short_line(const std::string& line)
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

inline std::vector<std::string> LogWorld::all_lines()
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

inline std::vector<std::string> expected_lines(int count)
{
    std::vector<std::string> lines;
    for (int i = 0; i < count; ++i) {
        lines.push_back(std::to_string(i) + " v" + std::to_string(i));
    }
    return lines;
}

inline std::string line_of(int serial)
{
    return std::to_string(serial) +
           "\t2017-10-17\t14:52:50\t747\tSERVER\t0111\tPublishedVariable\tv\t2Byte\t1\t0\r\n";
}

} // namespace busbar::test
