#include "execution_log_files.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <busbar/core/text_forms.hpp>

#include "log_text.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::string_view full_log_prefix = "OPCUA_ExecutionLog_";
constexpr std::string_view log_ending = ".log";
constexpr std::size_t digits_of_time = 17;
/// Maximum number of names looked at in the folder, whether they are log files or not.
constexpr std::size_t max_listed = 10'000;
/// Number of repaired lines that a file may have in addition to its records.
constexpr std::size_t spare_lines = 1'000;
constexpr std::size_t batch_records = 256;
constexpr std::string_view control_header = "busbar execution log 1\r\n";
constexpr std::string_view control_serial = "next ";
constexpr std::string_view control_records = "records ";

/// Reads the number at the front, at most 65,535.
std::optional<std::uint16_t> leading_serial(std::string_view line, char end)
{
    std::uint16_t serial = 0;
    const auto read = std::from_chars(line.data(), line.data() + line.size(), serial);
    const auto size = static_cast<std::size_t>(read.ptr - line.data());
    const bool is_good = read.ec == std::errc{} && size < line.size() && line[size] == end;
    return is_good ? std::optional{serial} : std::nullopt;
}

/// Reads the local time in the name of a full file. Nothing for other names, and for the year 9999:
/// the log never writes that, and no later name would exist.
std::optional<DateTime> time_of_name(std::string_view name)
{
    if (name.size() != full_log_prefix.size() + digits_of_time + log_ending.size() ||
        !name.starts_with(full_log_prefix) || !name.ends_with(log_ending) ||
        name.substr(full_log_prefix.size(), 4) == "9999") {
        return std::nullopt;
    }
    const std::string digits{name.substr(full_log_prefix.size(), digits_of_time)};
    return parse_date_time(digits.substr(0, 4) + "-" + digits.substr(4, 2) + "-" +
                           digits.substr(6, 2) + "T" + digits.substr(8, 2) + ":" +
                           digits.substr(10, 2) + ":" + digits.substr(12, 2) + "." +
                           digits.substr(14) + "Z");
}

/// Returns the name for the following millisecond.
std::string name_behind(std::string_view path)
{
    const DateTime time = time_of_name(path.substr(path.rfind('/') + 1)).value_or(DateTime{});
    return full_log_name({time.ticks + DateTime::ticks_per_second / 1'000}, {});
}

std::uint16_t after(std::uint16_t serial, std::size_t count = 1)
{
    return static_cast<std::uint16_t>(serial + count); // 65,535 is followed by 0
}

} // namespace

std::string full_log_name(DateTime time, TimeZone zone)
{
    const LocalTimeTexts texts = local_time_texts(time, zone);
    std::string digits = texts.date + texts.time + texts.millisecond;
    std::erase_if(digits, [](char c) { return c == '-' || c == ':'; });
    return std::string{full_log_prefix} + digits + std::string{log_ending};
}

bool is_full_log_name(std::string_view name)
{
    return time_of_name(name).has_value();
}

Stored<std::vector<std::string>> full_logs(Storage& storage, std::string_view folder)
{
    const auto listing = storage.list(folder, max_listed);
    if (!listing) {
        return listing.error() == StorageError::NotFound ? Stored<std::vector<std::string>>{}
                                                         : not_stored(listing.error());
    }
    std::vector<std::string> names;
    for (const StorageEntry& entry : listing->entries) {
        if (entry.kind == StorageEntry::Kind::File && is_full_log_name(entry.name)) {
            names.push_back(storage_path(folder, entry.name));
        }
    }
    return names;
}

std::size_t max_log_size(std::size_t max_records)
{
    return (max_records + spare_lines) * max_execution_log_record;
}

ExecutionLogFiles::ExecutionLogFiles(Storage& storage, const WallClock& clock,
                                     const ExecutionLogOptions& options)
    : storage_{&storage}, clock_{&clock}, options_{options},
      file_{storage, storage_path(options.folder, current_log_name),
            max_log_size(options.max_records)}
{
}

Stored<void> ExecutionLogFiles::open()
{
    auto opened = file_.refresh();
    if (!opened && opened.error() == StorageError::TooLarge) {
        // A file of another program or other settings is kept as a full one.
        opened = begin_new_file();
    }
    if (opened && file_.size() == 0) {
        opened = storage_->make_folder(options_.folder, FileAccess::Everyone).and_then([&] {
            return remove_oldest();
        });
    }
    if (opened && !next_serial_) {
        storage_->remove_unfinished(options_.folder);
        storage_->remove_unfinished(options_.system_folder);
        opened = find_serial();
    }
    return opened;
}

/// Finds the next serial number, which continues across files and restarts (W588, 7-1-6).
Stored<void> ExecutionLogFiles::find_serial()
{
    if (const auto last = leading_serial(file_.last_line(), '\t')) {
        next_serial_ = after(*last);
        return {};
    }
    const auto of_full = serial_of_full_logs();
    if (!of_full) {
        return not_stored(of_full.error());
    }
    const auto noted = read_control();
    // Take the later one; numbers wrap around.
    const bool is_noted = noted && (!*of_full || static_cast<std::int16_t>(*noted - **of_full) > 0);
    next_serial_ = is_noted ? *noted : of_full->value_or(0);
    return {};
}

Stored<std::optional<std::uint16_t>> ExecutionLogFiles::serial_of_full_logs()
{
    const auto names = full_logs(*storage_, options_.folder);
    if (!names) {
        return not_stored(names.error());
    }
    std::optional<std::uint16_t> serial;
    if (!names->empty()) {
        LineFile newest{*storage_, names->back(), max_log_size(options_.max_records)};
        // A file of another program has no usable number.
        if (newest.open()) {
            serial = leading_serial(newest.last_line(), '\t');
        }
    }
    return serial ? after(*serial) : serial;
}

std::optional<std::uint16_t> ExecutionLogFiles::read_control()
{
    constexpr std::size_t max_size = 1'024;
    const auto bytes =
        read_file(*storage_, storage_path(options_.system_folder, log_control_name), max_size);
    if (!bytes) {
        return std::nullopt;
    }
    std::string_view text{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    for (const std::string_view expected : {control_header, control_serial}) {
        if (!text.starts_with(expected)) {
            return std::nullopt;
        }
        text.remove_prefix(expected.size());
    }
    return leading_serial(text, '\r');
}

Stored<void> ExecutionLogFiles::write_control()
{
    if (!next_serial_) {
        return {};
    }
    std::string text{control_header};
    text.append(control_serial).append(std::to_string(*next_serial_)).append("\r\n");
    text.append(control_records).append(std::to_string(file_.lines())).append("\r\n");
    const std::string name = storage_path(options_.system_folder, log_control_name);
    if (text == control_ && storage_->entry(name)) {
        return {};
    }
    control_.clear();
    if (auto made = storage_->make_folder(options_.system_folder, FileAccess::Everyone); !made) {
        return made;
    }
    auto written = storage_->replace(name, std::as_bytes(std::span{text}), FileAccess::Everyone);
    if (written) {
        control_ = std::move(text);
    }
    return written;
}

/// Renames the current file by the time (W588, 7-1-5), but after all others: the first by name must
/// be the oldest even if the clock was set back.
Stored<void> ExecutionLogFiles::begin_new_file()
{
    const auto names = full_logs(*storage_, options_.folder);
    if (!names) {
        return not_stored(names.error());
    }
    std::string name =
        storage_path(options_.folder, full_log_name(clock_->now(), clock_->time_zone()));
    if (!names->empty() && name <= names->back()) {
        name = storage_path(options_.folder, name_behind(names->back()));
    }
    if (auto moved = file_.move_to(name, WhenThere::Refuse); !moved) {
        return moved;
    }
    // It is needed only after a restart without any log file.
    static_cast<void>(write_control());
    if (auto removed = remove_oldest(); !removed) {
        return removed;
    }
    return file_.refresh();
}

Stored<void> ExecutionLogFiles::remove_oldest()
{
    const auto names = full_logs(*storage_, options_.folder);
    if (!names) {
        return not_stored(names.error());
    }
    const std::size_t most = options_.max_files - 1; // besides the current one
    for (std::size_t i = 0; i + most < names->size(); ++i) {
        if (auto removed = storage_->remove((*names)[i]); !removed) {
            return removed;
        }
    }
    return {};
}

ExecutionLogFiles::Outcome ExecutionLogFiles::save(std::span<const WaitingLogItem> items)
{
    auto done = open();
    if (const std::size_t found = std::min(file_.take_found(), items.size());
        found != 0 && next_serial_) {
        next_serial_ = after(*next_serial_, found);
        return {found, {}};
    }
    if (done && file_.lines() >= options_.max_records) {
        done = begin_new_file();
    }
    if (!done) {
        return {0, done.error()};
    }
    const std::size_t room = options_.max_records - file_.lines();
    items = items.first(std::min({items.size(), room, batch_records}));
    if (auto added = file_.append(records_of(items)); !added) {
        return {0, added.error()};
    }
    next_serial_ = after(*next_serial_, items.size());
    return {items.size(), {}};
}

std::string ExecutionLogFiles::records_of(std::span<const WaitingLogItem> items) const
{
    std::string lines;
    std::uint16_t serial = *next_serial_;
    for (const WaitingLogItem& each : items) {
        lines += execution_log_record(serial, each.time, each.zone, each.item);
        serial = after(serial);
    }
    return lines;
}

Stored<void> ExecutionLogFiles::complete()
{
    auto done = open();
    if (done && file_.size() != 0) {
        done = begin_new_file();
    }
    return done ? file_.create() : done;
}

Stored<void> ExecutionLogFiles::clear()
{
    if (auto opened = open(); !opened) {
        return opened;
    }
    // Write this first, so that numbers continue if power fails in between.
    if (auto written = write_control(); !written) {
        return written;
    }
    const auto names = full_logs(*storage_, options_.folder);
    if (!names) {
        return not_stored(names.error());
    }
    for (const std::string& each : *names) {
        if (auto removed = storage_->remove(each); !removed) {
            return removed;
        }
    }
    return file_.remove();
}

} // namespace busbar::controller::detail
