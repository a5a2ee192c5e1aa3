#include "remote_log.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "lines.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool::admin {

namespace {

constexpr const char* log_folder = "ExecutionLog";
/// 65,536 records of 256 bytes are 16 MiB (W588, 7-1-5).
constexpr std::size_t max_log_size = 64U << 20U;
constexpr std::size_t max_log_files = 100;

std::string path_of(const NamedChild& file)
{
    return std::string{log_folder} + "/" + file.name;
}

/// Name of the last full file; empty if there is none.
std::string newest_full(const std::vector<NamedChild>& files)
{
    const auto found = std::find_if(files.rbegin(), files.rend(), [](const NamedChild& file) {
        return !is_current_log(file.name);
    });
    return found == files.rend() ? std::string{} : found->name;
}

/// Removes a last line without its end, which is still being written.
std::string whole_lines(std::string text)
{
    text.resize(text.rfind('\n') + 1); // npos + 1: none
    return text;
}

/// Serial numbers of the first and the last record; nothing if there is none.
std::optional<std::pair<std::uint16_t, std::uint16_t>> ends_of(std::string_view lines)
{
    std::optional<std::pair<std::uint16_t, std::uint16_t>> ends;
    while (!lines.empty()) {
        std::string_view line = lines.substr(0, lines.find('\n'));
        lines.remove_prefix(std::min(lines.size(), line.size() + 1));
        line = line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
        if (const auto entry = controller::parse_execution_log_record(line)) {
            ends = {ends ? ends->first : entry->serial_number, entry->serial_number};
        }
    }
    return ends;
}

Failure no_log(Connection& connection)
{
    const EndpointDescription* const endpoint = connection.client().endpoint();
    if (endpoint != nullptr && endpoint->security_mode != MessageSecurityMode::SignAndEncrypt) {
        return Failure{Exit::Refused, "files of a server go over encrypted connections only",
                       "connect with --mode SignAndEncrypt"};
    }
    return Failure{Exit::Failed, "the server shares no execution log, or this user may not see it",
                   "a busbar-controller has one with execution_log = true in [machine], for users "
                   "with the role Operator, Supervisor, Engineer, ConfigureAdmin or "
                   "SecurityAdmin"};
}

} // namespace

RemoteLog::RemoteLog(Connection& connection)
    : connection_{connection}, folder_{look_for_file(connection, log_folder)}
{
    if (folder_.is_null()) {
        throw no_log(connection);
    }
}

std::vector<NamedChild> RemoteLog::files()
{
    std::vector<NamedChild> files = objects_below(connection_, folder_);
    std::erase_if(files, [](const NamedChild& file) { return !is_log_name(file.name); });
    std::sort(files.begin(), files.end(), [](const NamedChild& a, const NamedChild& b) {
        return std::pair{is_current_log(a.name), a.name} <
               std::pair{is_current_log(b.name), b.name};
    });
    const std::size_t surplus = files.size() - std::min(files.size(), max_log_files);
    files.erase(files.begin(), files.begin() + static_cast<std::ptrdiff_t>(surplus));
    return files;
}

std::string RemoteLog::fetch(const NamedChild& file, std::uint64_t offset)
{
    return download(connection_, file.id, path_of(file),
                    {.offset = offset, .max_size = max_log_size, .is_growing = true});
}

std::string RemoteLog::fetch_if_there(const NamedChild& file, std::uint64_t offset)
{
    try {
        return fetch(file, offset);
    } catch (const Failure& failure) {
        if (failure.status != status::Bad_NotFound && failure.status != status::Bad_NodeIdUnknown) {
            throw;
        }
        return {};
    }
}

std::vector<NamedChild> RemoteLog::complete_files()
{
    call_on_file(connection_, folder_, log_folder, "BeginNewFile", {});
    std::vector<NamedChild> complete = files();
    std::erase_if(complete, [](const NamedChild& file) { return is_current_log(file.name); });
    return complete;
}

void RemoteLog::remove(const NamedChild& file)
{
    call_on_file(connection_, folder_, log_folder, "Delete", {Variant{file.id}});
}

controller::ExecutionLogContents RemoteLog::last_of(const std::vector<NamedChild>& files,
                                                    const controller::ExecutionLogFilter& filter,
                                                    std::size_t count)
{
    controller::ExecutionLogContents all;
    newest_full_ = newest_full(files);
    offset_ = 0;
    serial_number_.reset();
    // Start at the end, because the last entries are wanted.
    for (auto file = files.rbegin(); file != files.rend(); ++file) {
        if (all.entries.size() >= count) {
            all.is_cut = true; // there may be no older matches, but they were not searched for
            break;
        }
        const std::string text = whole_lines(fetch_if_there(*file));
        if (const auto ends = serial_number_ ? std::nullopt : ends_of(text)) {
            serial_number_ = ends->second;
        }
        offset_ = is_current_log(file->name) ? text.size() : offset_;
        auto part = controller::read_execution_log(text, filter, count - all.entries.size());
        all.entries.insert(all.entries.begin(), std::make_move_iterator(part.entries.begin()),
                           std::make_move_iterator(part.entries.end()));
        all.is_cut = all.is_cut || part.is_cut;
        all.damaged += part.damaged;
    }
    return all;
}

controller::ExecutionLogContents RemoteLog::last(const controller::ExecutionLogFilter& filter,
                                                 std::size_t count)
{
    constexpr unsigned most_attempts = 3;
    for (unsigned attempt = 1;; ++attempt) {
        auto contents = last_of(files(), filter, count);
        // Repeat if a file became full in the meantime, because it was not in the list.
        if (attempt == most_attempts || newest_full(files()) == newest_full_) {
            return contents;
        }
    }
}

void RemoteLog::fetch_new(const Show& show)
{
    for (const NamedChild& file : files()) {
        if (is_current_log(file.name)) {
            fetch_new_of_current(file, show);
        } else if (file.name > newest_full_) {
            pass(whole_lines(fetch_if_there(file, offset_)), show);
            newest_full_ = file.name;
            offset_ = 0;
            is_shorter_ = false;
        }
    }
}

void RemoteLog::fetch_new_of_current(const NamedChild& file, const Show& show)
{
    const auto size = file_property(connection_, file.id, "Size").value_or<std::uint64_t>(offset_);
    // The file was cleared and started again, or became full, which the next list shows.
    if (size < offset_ && !std::exchange(is_shorter_, true)) {
        return;
    }
    is_shorter_ = false;
    if (size == offset_) {
        return;
    }
    offset_ = size < offset_ ? 0 : offset_;
    const std::string text = whole_lines(fetch_if_there(file, offset_));
    offset_ += text.size();
    pass(text, show);
}

void RemoteLog::pass(const std::string& text, const Show& show)
{
    std::size_t missing = 0;
    if (const auto ends = ends_of(text)) {
        // Numbers continue across files and restarts, 0 after 65,535 (W588, 7-1-6); a log that was
        // cleared together with the controller's memory begins again.
        constexpr std::uint16_t most = 0x7FFF;
        const auto between = static_cast<std::uint16_t>(
            ends->first - serial_number_.value_or(ends->first - 1U) - 1U);
        missing = between <= most ? between : 0;
        serial_number_ = ends->second;
    }
    show(text, missing);
}

} // namespace busbar::tool::admin
