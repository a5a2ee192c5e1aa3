#include <busbar/controller/execution_log.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "execution_log_files.hpp"
#include "once_per_certificate.hpp"

namespace busbar::controller {

namespace {

// The reasons why records cannot be saved (W588, 9-2-2, 15000000).
constexpr std::uint16_t code_away = 0x0001;
constexpr std::uint16_t code_unusable = 0x0002;
constexpr std::uint16_t code_protected = 0x0003;
constexpr std::uint16_t code_full = 0x0005;
constexpr std::uint16_t code_other = 0x0302;

constexpr std::size_t most_at_once = 256;

std::uint16_t code_of(StorageError error)
{
    switch (error) {
    case StorageError::Away:
        return code_away;
    case StorageError::Protected:
        return code_protected;
    case StorageError::Full:
        return code_full;
    default:
        return code_other;
    }
}

struct LogOptionRange {
    std::string_view name;
    std::size_t value;
    std::size_t least;
    std::size_t most;
};

std::optional<Problem> problem_of_options(const ExecutionLogOptions& options)
{
    const std::array ranges{
        LogOptionRange{"max_files", options.max_files, 2, 100},
        LogOptionRange{"max_records", options.max_records, 100, 65'536},
        LogOptionRange{"max_waiting", options.max_waiting, 600, 10'000'000},
    };
    for (const LogOptionRange& range : ranges) {
        if (range.value < range.least || range.value > range.most) {
            return Problem{.where = std::string{range.name},
                           .text = std::to_string(range.value) + " is out of range, expected " +
                                   std::to_string(range.least) + " to " +
                                   std::to_string(range.most)};
        }
    }
    for (const auto& [name, folder] : {std::pair{"folder", &options.folder},
                                       std::pair{"system_folder", &options.system_folder}}) {
        if (!is_storage_name(*folder)) {
            return Problem{.where = name, .text = "is not a valid folder name"};
        }
    }
    return std::nullopt;
}

} // namespace

Configured<std::unique_ptr<ExecutionLog>> ExecutionLog::create(Storage& medium,
                                                               const WallClock& clock,
                                                               LogSink& next,
                                                               ExecutionLogOptions options)
{
    if (auto problem = problem_of_options(options)) {
        return Unexpected<Problem>{*std::move(problem)};
    }
    return std::unique_ptr<ExecutionLog>{new ExecutionLog{medium, clock, next, std::move(options)}};
}

ExecutionLog::ExecutionLog(Storage& medium, const WallClock& clock, LogSink& next,
                           ExecutionLogOptions options)
    : clock_{&clock}, next_{&next}, options_{std::move(options)},
      once_{std::make_unique<detail::OncePerCertificate>()},
      files_{std::make_unique<detail::ExecutionLogFiles>(medium, clock, options_)}
{
}

ExecutionLog::~ExecutionLog() = default;

void ExecutionLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    next_->write(level, source, text);
}

bool ExecutionLog::wants(RecordKind kind) const
{
    return is_in_execution_log(kind) || next_->wants(kind);
}

void ExecutionLog::record(const Record& record)
{
    if (next_->wants(record.kind)) {
        next_->record(record);
    }
    if (!is_in_execution_log(record.kind)) {
        return;
    }
    const DateTime now = clock_->now();
    const TimeZone zone = clock_->time_zone();
    auto items = execution_log_items(record, now);
    const std::lock_guard lock{queue_mutex_};
    if (!once_->is_new(record)) {
        return;
    }
    for (ExecutionLogItem& item : items) {
        if (queue_.size() < options_.max_waiting) {
            queue_.push_back({now, zone, std::move(item)});
        } else {
            ++lost_;
            has_overflowed_ = true;
        }
    }
}

std::optional<std::uint16_t> ExecutionLog::known_fault() const
{
    const std::lock_guard lock{queue_mutex_};
    return medium_ == LogMedium::In    ? std::nullopt
           : medium_ == LogMedium::Out ? std::optional{code_away}
                                       : std::optional{code_unusable};
}

Stored<void> ExecutionLog::write_pending()
{
    const std::lock_guard lock{files_mutex_};
    const auto fault = known_fault();
    auto saved = fault ? Stored<void>{not_stored(StorageError::Away)} : save_all();
    bool has_overflowed = false;
    {
        const std::lock_guard queue_lock{queue_mutex_};
        has_overflowed = std::exchange(has_overflowed_, false);
    }
    // Records that wait for a removed medium are not lost yet (W588, 7-4-3).
    const bool is_useless = fault == code_unusable && waiting() != 0;
    if (fault && (has_overflowed || is_useless)) {
        tell_lost(*fault);
    } else if (!fault && !saved) {
        tell_lost(code_of(saved.error()));
    } else if (!fault && has_overflowed) { // records arrived faster than they could be saved
        tell_lost(code_other);
    }
    if (saved) {
        tell_saved();
    }
    return saved;
}

Stored<void> ExecutionLog::save_all()
{
    for (;;) {
        std::vector<detail::WaitingLogItem> items;
        {
            const std::lock_guard lock{queue_mutex_};
            const std::size_t count = std::min(queue_.size(), most_at_once);
            items.assign(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
        }
        if (items.empty()) {
            return {};
        }
        const auto outcome = files_->save(items);
        drop_front(outcome.saved);
        if (outcome.error) {
            return not_stored(*outcome.error);
        }
    }
}

void ExecutionLog::drop_front(std::size_t count)
{
    const std::lock_guard lock{queue_mutex_};
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
}

Stored<void> ExecutionLog::flush()
{
    auto saved = prepare_removal();
    const std::lock_guard lock{files_mutex_};
    if (const auto fault = known_fault(); !saved && fault && waiting() != 0) {
        tell_lost(*fault);
    }
    return saved;
}

Stored<void> ExecutionLog::prepare_removal()
{
    auto saved = write_pending();
    const std::lock_guard lock{files_mutex_};
    return saved ? files_->write_control() : saved;
}

Stored<void> ExecutionLog::release_medium()
{
    auto saved = flush();
    medium_changed(LogMedium::Out);
    return saved;
}

void ExecutionLog::medium_changed(LogMedium medium)
{
    const std::lock_guard lock{files_mutex_};
    files_->close();
    const std::lock_guard queue_lock{queue_mutex_};
    medium_ = medium;
}

Stored<void> ExecutionLog::begin_new_file()
{
    // Records that cannot be saved now wait and become part of the next file.
    static_cast<void>(write_pending());
    const std::lock_guard lock{files_mutex_};
    return known_fault() ? Stored<void>{not_stored(StorageError::Away)} : files_->complete();
}

bool ExecutionLog::is_complete_file(std::string_view name)
{
    return detail::is_full_log_name(name);
}

Stored<void> ExecutionLog::clear()
{
    const std::lock_guard lock{files_mutex_};
    return known_fault() ? Stored<void>{not_stored(StorageError::Away)} : files_->clear();
}

std::size_t ExecutionLog::waiting() const
{
    const std::lock_guard lock{queue_mutex_};
    return queue_.size();
}

std::uint64_t ExecutionLog::lost() const
{
    const std::lock_guard lock{queue_mutex_};
    return lost_;
}

void ExecutionLog::tell_lost(std::uint16_t code)
{
    if (std::exchange(is_told_, true)) {
        return;
    }
    const std::array fields{RecordField{"Code", Variant{code}}};
    Record record{RecordKind::ExecutionLogLost, LogLevel::Error, "execution log"};
    record.text = "records of the execution log cannot be saved; some may be lost";
    record.status = status::Bad_ResourceUnavailable;
    record.fields = fields;
    tell(*next_, record);
}

void ExecutionLog::tell_saved()
{
    if (std::exchange(is_told_, false)) {
        Record record{RecordKind::ExecutionLogSaved, LogLevel::Info, "execution log"};
        record.text = "records of the execution log are saved again";
        tell(*next_, record);
    }
}

} // namespace busbar::controller
