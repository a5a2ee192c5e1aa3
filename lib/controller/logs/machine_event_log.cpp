#include <busbar/controller/machine_event_log.hpp>

#include <algorithm>
#include <utility>

#include "machine_event_files.hpp"
#include "machine_event_rules.hpp"

namespace busbar::controller {

namespace {

std::optional<Problem> problem_of_events(const MachineEventLogOptions& options)
{
    constexpr std::size_t least = 16;
    constexpr std::size_t most = 100'000;
    if (options.max_entries < least || options.max_entries > most) {
        return Problem{.where = "max_entries",
                       .text = std::to_string(options.max_entries) +
                               " is out of range, expected 16 to 100000"};
    }
    if (!is_storage_name(options.folder)) {
        return Problem{.where = "folder", .text = "is not a valid folder name"};
    }
    for (std::size_t i = 0; i < options.levels.size(); ++i) {
        const EventLevelChoice& choice = options.levels[i];
        const MachineEventType* const type = machine_event_type(choice.code);
        if (type == nullptr || (choice.level != type->level && choice.level != type->other_level)) {
            return Problem{.where = "levels[" + std::to_string(i) + "]",
                           .text = type == nullptr ? "there is no event of this code"
                                                   : code_text(*type) + " cannot have the level " +
                                                         std::string{name(choice.level)}};
        }
    }
    return std::nullopt;
}

/// Position of the level, above the code, in a packed PlcError.
constexpr unsigned level_shift = 32;

/// Packs the worst error into one number, which is not 0 because no fault has the level 0.
std::uint64_t packed_error(std::span<const MachineEvent> standing)
{
    static_assert(static_cast<std::uint8_t>(EventLevel::PartialFault) != 0);
    std::optional<PlcError> highest;
    for (const MachineEvent& each : standing) {
        if (each.level != EventLevel::PartialFault && each.level != EventLevel::MinorFault) {
            continue;
        }
        const PlcError found{each.level, each.type->code};
        if (!highest || found.level < highest->level ||
            (found.level == highest->level && found.code > highest->code)) {
            highest = found;
        }
    }
    return highest ? (static_cast<std::uint64_t>(highest->level) << level_shift) | highest->code
                   : 0;
}

} // namespace

Configured<std::unique_ptr<MachineEventLog>>
MachineEventLog::create(Storage& storage, const WallClock& clock, LogSink& next,
                        MachineEventListener* listener, MachineEventLogOptions options)
{
    if (auto problem = problem_of_events(options)) {
        return Unexpected<Problem>{*std::move(problem)};
    }
    return std::unique_ptr<MachineEventLog>{
        new MachineEventLog{storage, clock, next, listener, std::move(options)}};
}

MachineEventLog::MachineEventLog(Storage& storage, const WallClock& clock, LogSink& next,
                                 MachineEventListener* listener, MachineEventLogOptions options)
    : clock_{&clock}, next_{&next}, listener_{listener}, options_{std::move(options)},
      rules_{std::make_unique<detail::MachineEventRules>(options_.levels)},
      files_{std::make_unique<detail::MachineEventFiles>(storage, options_.folder,
                                                         options_.max_entries)}
{
}

MachineEventLog::~MachineEventLog() = default;

void MachineEventLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    next_->write(level, source, text);
}

bool MachineEventLog::wants(RecordKind kind) const
{
    return detail::MachineEventRules::wants(kind) || next_->wants(kind);
}

void MachineEventLog::record(const Record& record)
{
    if (next_->wants(record.kind)) {
        next_->record(record);
    }
    if (!detail::MachineEventRules::wants(record.kind)) {
        return;
    }
    const DateTime now = clock_->now();
    std::vector<MachineEvent> events;
    bool has_other_errors = false;
    {
        const std::lock_guard lock{mutex_};
        const std::uint64_t changes = rules_->changes();
        events = rules_->take(record, now);
        has_other_errors = rules_->changes() != changes;
        if (has_other_errors) {
            plc_error_ = packed_error(rules_->standing());
        }
        for (MachineEvent& event : events) {
            event.number = ++last_number_;
            keep(event);
        }
    }
    if (listener_ != nullptr) {
        for (const MachineEvent& event : events) {
            listener_->happened(event);
        }
        if (has_other_errors) {
            listener_->errors_changed();
        }
    }
}

void MachineEventLog::keep(const MachineEvent& event)
{
    events_.push_back(event);
    unsaved_ = std::min(unsaved_ + 1, options_.max_entries);
    if (events_.size() > options_.max_entries) {
        events_.pop_front();
    }
}

Stored<void> MachineEventLog::load()
{
    const std::lock_guard lock{files_mutex_};
    return load_once();
}

Stored<void> MachineEventLog::load_once()
{
    if (is_loaded_) {
        return {};
    }
    auto before = files_->load();
    if (!before) {
        return not_stored(before.error());
    }
    is_loaded_ = true;
    const std::lock_guard lock{mutex_};
    const std::uint64_t last = before->empty() ? 0 : before->back().number;
    for (MachineEvent& event : events_) {
        event.number += last;
        before->push_back(std::move(event));
    }
    while (before->size() > options_.max_entries) {
        before->pop_front();
    }
    events_ = *std::move(before);
    last_number_ += last;
    return {};
}

Stored<void> MachineEventLog::write_pending()
{
    const std::lock_guard files_lock{files_mutex_};
    if (auto loaded = load_once(); !loaded) {
        return loaded;
    }
    for (;;) {
        std::vector<MachineEvent> events;
        {
            const std::lock_guard lock{mutex_};
            events.assign(events_.end() - static_cast<std::ptrdiff_t>(unsaved_), events_.end());
        }
        if (events.empty()) {
            return {};
        }
        const auto saved = files_->save(events);
        if (!saved) {
            return not_stored(saved.error());
        }
        const std::lock_guard lock{mutex_};
        // Compare by number, because the oldest event may have been dropped in the meantime.
        const std::uint64_t last_saved = events[*saved - 1].number;
        unsaved_ = std::min<std::size_t>(unsaved_, last_number_ - last_saved);
    }
}

std::vector<MachineEvent> MachineEventLog::events() const
{
    const std::lock_guard lock{mutex_};
    return {events_.begin(), events_.end()};
}

std::vector<MachineEvent> MachineEventLog::current_errors() const
{
    const std::lock_guard lock{mutex_};
    return rules_->standing();
}

std::optional<PlcError> MachineEventLog::plc_error() const
{
    const std::uint64_t packed = plc_error_.load();
    const auto level = static_cast<EventLevel>(packed >> level_shift);
    return packed != 0 ? std::optional{PlcError{level, static_cast<std::uint32_t>(packed)}}
                       : std::nullopt;
}

} // namespace busbar::controller
