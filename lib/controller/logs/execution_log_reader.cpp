#include <busbar/controller/execution_log_reader.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

#include <busbar/core/text_forms.hpp>

#include "execution_log_files.hpp"
#include "log_text.hpp"

namespace busbar::controller {

namespace {

constexpr std::size_t max_records_of_file = 65'536;

/// Takes the text before the next tab, and the tab.
std::string_view take_column(std::string_view& line)
{
    const std::size_t end = line.find('\t');
    const std::string_view column = line.substr(0, end);
    line.remove_prefix(std::min(line.size(), column.size() + 1));
    return column;
}

/// Parses between `least` and `most` decimal digits.
std::optional<std::uint16_t> digits_of(std::string_view text, std::size_t least, std::size_t most)
{
    std::uint16_t number = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    const bool is_good =
        text.size() >= least && text.size() <= most && read.ec == std::errc{} && read.ptr == end;
    return is_good ? std::optional{number} : std::nullopt;
}

/// Parses a time that the log could have written.
std::optional<DateTime> time_of_columns(std::string_view date, std::string_view time_of_day,
                                        std::string_view millisecond)
{
    std::string text{date};
    text.append("T").append(time_of_day).append(".").append(millisecond).append("Z");
    const auto time = parse_date_time(text);
    if (!time) {
        return std::nullopt;
    }
    const detail::LocalTimeTexts texts = detail::local_time_texts(*time, {});
    const bool is_same =
        texts.date == date && texts.time == time_of_day && texts.millisecond == millisecond;
    return is_same ? time : std::nullopt;
}

const ExecutionLogCode* code_of_columns(std::string_view category, std::string_view code,
                                        std::string_view name)
{
    const auto number = digits_of(code, 4, 4);
    for (const ExecutionLogCode& each : execution_log_codes()) {
        if (each.category == category && each.code == number && each.name == name) {
            return &each;
        }
    }
    return nullptr;
}

bool are_details(std::string_view details)
{
    std::string cleaned = detail::clean_text(details, max_execution_log_details);
    for (std::size_t i = 0; i < cleaned.size() && i < details.size(); ++i) {
        cleaned[i] = details[i] == '\t' ? '\t' : cleaned[i];
    }
    return cleaned == details;
}

char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool contains_text(std::string_view text, std::string_view part)
{
    const auto is_same = [](char a, char b) { return lower(a) == lower(b); };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), is_same) != text.end() ||
           part.empty();
}

/// Appends younger contents and keeps the last entries of both.
void add_contents(ExecutionLogContents& all, ExecutionLogContents more, std::size_t max_entries)
{
    all.entries.insert(all.entries.end(), std::make_move_iterator(more.entries.begin()),
                       std::make_move_iterator(more.entries.end()));
    all.is_cut = all.is_cut || more.is_cut || all.entries.size() > max_entries;
    all.damaged += more.damaged;
    const std::size_t surplus = all.entries.size() - std::min(all.entries.size(), max_entries);
    all.entries.erase(all.entries.begin(),
                      all.entries.begin() + static_cast<std::ptrdiff_t>(surplus));
}

} // namespace

std::optional<ExecutionLogEntry> parse_execution_log_record(std::string_view line)
{
    if (line.size() + 2 > max_execution_log_record) {
        return std::nullopt;
    }
    const auto serial = digits_of(take_column(line), 1, 5);
    const std::string_view date = take_column(line);
    const std::string_view time_of_day = take_column(line);
    const auto time = time_of_columns(date, time_of_day, take_column(line));
    const std::string_view category = take_column(line);
    const std::string_view code = take_column(line);
    const ExecutionLogCode* const found = code_of_columns(category, code, take_column(line));
    if (!serial || !time || found == nullptr || !are_details(line)) {
        return std::nullopt;
    }
    return ExecutionLogEntry{*serial, *time, found, std::string{line}};
}

bool matches(const ExecutionLogEntry& entry, const ExecutionLogFilter& filter)
{
    return (filter.category.empty() || filter.category == entry.code->category) &&
           (!filter.code || *filter.code == entry.code->code) &&
           (filter.from.is_null() || entry.time >= filter.from) &&
           (filter.to.is_null() || entry.time < filter.to) &&
           (contains_text(entry.code->name, filter.text) ||
            contains_text(entry.details, filter.text));
}

ExecutionLogContents read_execution_log(std::string_view text, const ExecutionLogFilter& filter,
                                        std::size_t max_entries)
{
    ExecutionLogContents contents;
    // Start at the end, because the last entries are wanted.
    text = text.substr(0, text.rfind('\n') + 1); // npos + 1: no line
    while (!text.empty()) {
        text.remove_suffix(1);
        const std::size_t begin = text.rfind('\n') + 1;
        std::string_view line = text.substr(begin);
        text = text.substr(0, begin);
        const bool has_end = line.ends_with('\r');
        line.remove_suffix(has_end ? 1 : 0);
        auto entry = has_end ? parse_execution_log_record(line) : std::nullopt;
        if (!entry) {
            ++contents.damaged;
        } else if (!matches(*entry, filter)) {
            continue;
        } else if (contents.entries.size() < max_entries) {
            contents.entries.push_back(*std::move(entry));
        } else {
            contents.is_cut = true;
        }
    }
    std::reverse(contents.entries.begin(), contents.entries.end());
    return contents;
}

Stored<ExecutionLogContents> read_execution_log(Storage& storage, std::string_view folder,
                                                const ExecutionLogFilter& filter,
                                                std::size_t max_entries)
{
    auto names = detail::full_logs(storage, folder);
    if (!names) {
        return not_stored(names.error());
    }
    names->push_back(storage_path(folder, detail::current_log_name));
    ExecutionLogContents all;
    for (const std::string& name : *names) {
        const auto bytes = read_file(storage, name, detail::max_log_size(max_records_of_file));
        if (bytes) {
            const std::string_view text{reinterpret_cast<const char*>(bytes->data()),
                                        bytes->size()};
            add_contents(all, read_execution_log(text, filter, max_entries), max_entries);
        } else if (bytes.error() == StorageError::TooLarge) {
            ++all.damaged;
        } else if (bytes.error() != StorageError::NotFound) { // a file removed after it was listed
            return not_stored(bytes.error());
        }
    }
    return all;
}

std::array<std::string, 6> execution_log_columns(const ExecutionLogEntry& entry)
{
    const detail::LocalTimeTexts local = detail::local_time_texts(entry.time, {});
    std::string date = local.date;
    std::replace(date.begin(), date.end(), '-', '/');
    std::string details = entry.details;
    std::replace(details.begin(), details.end(), '\t', ' ');
    return {std::to_string(entry.serial_number), date + "/" + local.time + "." + local.millisecond,
            std::string{entry.code->category},   detail::padded(entry.code->code, 4),
            std::string{entry.code->name},       std::move(details)};
}

} // namespace busbar::controller
