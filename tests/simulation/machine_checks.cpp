#include "machine_checks.hpp"

#include <algorithm>
#include <charconv>
#include <string>

namespace busbar::test {

using controller::ExecutionLogContents;
using controller::ExecutionLogEntry;
using controller::MachineEvent;

namespace {

/// Files go when they are full, and the oldest one only when there are so many.
constexpr std::size_t always_kept = 2 * SavedRecords::records_of_file;

/// In the order in which they stand.
std::vector<std::uint64_t> numbers_of(const std::vector<ExecutionLogEntry>& entries)
{
    std::vector<std::uint64_t> numbers;
    for (const ExecutionLogEntry& entry : entries) {
        std::string_view details{entry.details};
        if (details.starts_with(SavedRecords::name)) {
            details.remove_prefix(SavedRecords::name.size());
            std::from_chars(details.data(), details.data() + details.size(),
                            numbers.emplace_back());
        }
    }
    return numbers;
}

} // namespace

void SavedRecords::saved()
{
    for (; first_unsaved_ <= told_; ++first_unsaved_) {
        saved_.insert(first_unsaved_);
    }
}

void SavedRecords::check(const ExecutionLogContents& contents, std::size_t damaged_lines)
{
    if (contents.damaged > damaged_lines) {
        trace_->violation(2, std::to_string(contents.damaged) + " lines are damaged");
    }
    const auto& entries = contents.entries;
    for (std::size_t i = 1; i < entries.size(); ++i) {
        if (entries[i].serial_number !=
            static_cast<std::uint16_t>(entries[i - 1].serial_number + 1)) {
            trace_->violation(2, "record " + std::to_string(entries[i].serial_number) +
                                     " comes after " +
                                     std::to_string(entries[i - 1].serial_number));
        }
    }
    const auto numbers = numbers_of(entries);
    if (std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal{}) != numbers.end()) {
        trace_->violation(2, "records stand in another order than they were told in, or twice");
    }
    if (entries.size() >= always_kept) {
        saved_.erase(saved_.begin(),
                     numbers.empty() ? saved_.end() : saved_.lower_bound(numbers.front()));
    }
    if (!std::includes(numbers.begin(), numbers.end(), saved_.begin(), saved_.end())) {
        trace_->violation(2, "of " + std::to_string(saved_.size()) + " saved records some of " +
                                 std::to_string(numbers.size()) + " are not there");
        saved_.clear();
    }
}

void SavedEvents::check(const std::vector<MachineEvent>& events)
{
    const auto is_kept = [&](const MachineEvent& saved) {
        if (events.empty() || saved.number < events.front().number) {
            return !events.empty(); // gone, since there are newer ones
        }
        const std::size_t at = saved.number - events.front().number;
        return at < events.size() && events[at].number == saved.number &&
               events[at].time == saved.time && events[at].type == saved.type &&
               events[at].attached == saved.attached;
    };
    if (!std::all_of(events_.begin(), events_.end(), is_kept)) {
        trace_->violation(1, "of " + std::to_string(events_.size()) +
                                 " saved events some are not there");
    }
}

} // namespace busbar::test
