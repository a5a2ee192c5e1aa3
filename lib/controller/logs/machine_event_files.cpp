#include "machine_event_files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <busbar/core/text_forms.hpp>

#include "log_text.hpp"

namespace busbar::controller {

namespace detail {

namespace {

/// Number of columns before the name: number, time, code and level.
constexpr std::size_t first_columns = 4;
constexpr std::size_t max_attached = 4;
constexpr std::size_t max_attached_size = 60;
constexpr std::size_t max_event_line = 400;
/// Large enough for a log that had more entries before its settings changed.
constexpr std::size_t max_event_file = 100'100 * max_event_line;
constexpr std::size_t event_batch = 256;

std::optional<std::uint64_t> whole_number(std::string_view text, int base)
{
    std::uint64_t number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number, base);
    const bool is_good = read.ec == std::errc{} && read.ptr == text.data() + text.size();
    return is_good ? std::optional{number} : std::nullopt;
}

std::optional<EventLevel> level_named(std::string_view text)
{
    for (const EventLevel level :
         {EventLevel::MajorFault, EventLevel::PartialFault, EventLevel::MinorFault,
          EventLevel::Observation, EventLevel::Information}) {
        if (name(level) == text) {
            return level;
        }
    }
    return std::nullopt;
}

std::vector<std::string_view> columns_of(std::string_view line)
{
    std::vector<std::string_view> columns;
    for (;;) {
        const std::size_t end = line.find('\t');
        columns.push_back(line.substr(0, end));
        if (end == std::string_view::npos) {
            return columns;
        }
        line.remove_prefix(end + 1);
    }
}

} // namespace

std::string machine_event_line(const MachineEvent& event)
{
    std::string line = std::to_string(event.number) + "\t" + to_string(event.time) + "\t" +
                       code_text(*event.type) + "\t" + std::string{name(event.level)} + "\t" +
                       std::string{event.type->name};
    for (const std::string& each : event.attached) {
        line += "\t" + clean_text(each, max_attached_size);
    }
    return line + "\r\n";
}

std::optional<MachineEvent> parse_machine_event(std::string_view line)
{
    if (line.size() > max_event_line) {
        return std::nullopt;
    }
    const auto columns = columns_of(line);
    if (columns.size() < first_columns || columns.size() > first_columns + 1 + max_attached) {
        return std::nullopt;
    }
    const auto number = whole_number(columns[0], 10);
    const auto time = parse_date_time(columns[1]);
    const auto code = whole_number(columns[2], 16);
    const auto level = level_named(columns[3]);
    const MachineEventType* const type = code && *code <= UINT32_MAX
                                             ? machine_event_type(static_cast<std::uint32_t>(*code))
                                             : nullptr;
    // The largest number is refused, because none could follow it.
    if (!number || *number > INT64_MAX || !time || type == nullptr || !level) {
        return std::nullopt;
    }
    MachineEvent event{*number, *time, type, *level, {}};
    const bool has_name = columns.size() > first_columns && columns[first_columns] == type->name;
    for (std::size_t i = first_columns + (has_name ? 1 : 0); i < columns.size(); ++i) {
        event.attached.push_back(clean_text(columns[i], max_attached_size));
    }
    return event;
}

MachineEventFiles::MachineEventFiles(Storage& storage, std::string folder, std::size_t max_entries)
    : storage_{&storage}, folder_{std::move(folder)}, before_{storage_path(folder_,
                                                                           "events_before.log")},
      max_entries_{max_entries}, file_{storage, storage_path(folder_, "events.log"), max_event_file}
{
}

Stored<std::deque<MachineEvent>> MachineEventFiles::load()
{
    auto opened = file_.open();
    if (!opened && opened.error() == StorageError::TooLarge) {
        opened = make_room(); // a file of another program, which is kept
    }
    std::deque<MachineEvent> events;
    const auto read = opened.and_then([&] { return read_into(events, before_); }).and_then([&] {
        return read_into(events, file_.name());
    });
    return read ? Stored<std::deque<MachineEvent>>{std::move(events)} : not_stored(read.error());
}

Stored<void> MachineEventFiles::read_into(std::deque<MachineEvent>& events, const std::string& name)
{
    const auto bytes = read_file(*storage_, name, max_event_file);
    if (!bytes) {
        const bool is_none =
            bytes.error() == StorageError::NotFound || bytes.error() == StorageError::TooLarge;
        return is_none ? Stored<void>{} : not_stored(bytes.error());
    }
    const std::string_view text{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    for (MachineEvent& event : read_machine_events(text)) {
        if (events.empty() || events.back().number < event.number) {
            events.push_back(std::move(event));
        }
        if (events.size() > max_entries_) {
            events.pop_front();
        }
    }
    return {};
}

/// Replaces the older file in one step, since power may fail at any time.
Stored<void> MachineEventFiles::make_room()
{
    return file_.move_to(before_, WhenThere::Replace).and_then([&] { return file_.refresh(); });
}

Stored<std::size_t> MachineEventFiles::save(std::span<const MachineEvent> events)
{
    auto ready = file_.refresh();
    if (file_.take_found() != 0) {
        const auto last = parse_machine_event(file_.last_line());
        const auto found = std::count_if(events.begin(), events.end(), [&](const auto& each) {
            return last && each.number <= last->number;
        });
        if (found != 0) {
            return static_cast<std::size_t>(found);
        }
    }
    if (ready && file_.size() == 0) {
        ready = storage_->make_folder(folder_, FileAccess::Everyone);
    }
    if (ready && file_.lines() >= max_entries_) {
        ready = make_room();
    }
    if (!ready) {
        return not_stored(ready.error());
    }
    const std::size_t room = max_entries_ - file_.lines();
    events = events.first(std::min({events.size(), room, event_batch}));
    std::string lines;
    for (const MachineEvent& each : events) {
        lines += machine_event_line(each);
    }
    const auto added = file_.append(lines);
    return added ? Stored<std::size_t>{events.size()} : not_stored(added.error());
}

} // namespace detail

std::vector<MachineEvent> read_machine_events(std::string_view text)
{
    std::vector<MachineEvent> events;
    // As in LineFile, a line feed ends a line.
    for (std::size_t end = 0; (end = text.find('\n')) != std::string_view::npos;) {
        const std::string_view line = text.substr(0, end);
        auto event = line.ends_with('\r') ? detail::parse_machine_event(line.substr(0, end - 1))
                                          : std::nullopt;
        if (event) {
            events.push_back(*std::move(event));
        }
        text.remove_prefix(end + 1);
    }
    return events;
}

} // namespace busbar::controller
