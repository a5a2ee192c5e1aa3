#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/execution_log_reader.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace log_reader_fuzz {

using namespace busbar;
using namespace busbar::controller;

namespace {

class FuzzClock final : public WallClock {
public:
    DateTime now() const override { return DateTime::from_unix_seconds(1'508'251'970); }
};

void must(bool is_so)
{
    if (!is_so) {
        std::abort();
    }
}

void put(Storage& storage, std::string_view folder, std::string_view name,
         std::span<const std::byte> bytes)
{
    must(storage.make_folder(folder, FileAccess::Everyone).has_value());
    must(storage.replace(storage_path(folder, name), bytes, FileAccess::Everyone).has_value());
}

/// What is read as a record is the record that would be written.
void check_entries(std::string_view text)
{
    const auto contents = read_execution_log(text, {}, 1'000);
    for (const ExecutionLogEntry& each : contents.entries) {
        const std::string line =
            execution_log_record(each.serial_number, each.time, {}, {each.code, each.details});
        must(line.size() <= max_execution_log_record);
        const auto again =
            read_execution_log(line, {.category = std::string{each.code->category}}, 1);
        must(again.entries.size() == 1 && again.damaged == 0);
        must(again.entries[0].details == each.details && again.entries[0].time == each.time);
        static_cast<void>(execution_log_columns(each));
    }
}

/// A log goes on behind whatever it finds, and what it adds can be read.
void go_on(std::span<const std::byte> bytes, std::string_view name)
{
    storage::MemoryStorage storage;
    const FuzzClock clock;
    NullLog next;
    put(storage, "log", name, bytes);
    put(storage, "system", "OPCUA_ExecutionLog.fjc", bytes);
    const auto log = std::move(
        ExecutionLog::create(
            storage, clock, next,
            {.max_files = 2, .max_records = 100, .folder = "log", .system_folder = "system"})
            .value());
    log->record(Record{RecordKind::ServerStarted});
    must(log->flush().has_value());
    const auto contents = read_execution_log(storage, "log", {}, 100'000);
    must(contents.has_value() && !contents->entries.empty());
    must(contents->entries.back().code->name == "Start");
}

void load_events(std::span<const std::byte> bytes)
{
    storage::MemoryStorage storage;
    const FuzzClock clock;
    NullLog next;
    put(storage, "events", "events.log", bytes);
    const auto log = std::move(
        MachineEventLog::create(storage, clock, next, nullptr, {.max_entries = 16}).value());
    must(log->load().has_value());
    log->record(Record{RecordKind::ServerStarted});
    const auto events = log->events();
    must(events.size() <= 16);
    must(log->write_pending().has_value());
    const auto again = std::move(
        MachineEventLog::create(storage, clock, next, nullptr, {.max_entries = 16}).value());
    must(again->load().has_value());
    must(again->events().size() == events.size());
    must(again->events().back().number == events.back().number);
}

} // namespace

/// Files of both logs that somebody wrote, or half of one.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const auto bytes = std::as_bytes(std::span{data, size});
    check_entries({reinterpret_cast<const char*>(data), size});
    go_on(bytes, "OPCUA_ExecutionLog.log");
    go_on(bytes, "OPCUA_ExecutionLog_20171017145250747.log");
    load_events(bytes);
    return 0;
}

} // namespace log_reader_fuzz
