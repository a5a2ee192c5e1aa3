#include "sequence_tracker.hpp"

#include <algorithm>

namespace busbar::client::detail {

namespace {

// 0 is not a sequence number (Part 4, 7.11.3: Counter values begin again with 1).
constexpr std::uint32_t last_number = 0xFFFF'FFFF;

} // namespace

std::optional<std::uint32_t> SequenceTracker::distance_to(std::uint32_t sequence_number) const
{
    if (sequence_number == 0) {
        return std::nullopt;
    }
    const std::uint32_t ahead = sequence_number >= next_ ? sequence_number - next_
                                                         : last_number - (next_ - sequence_number);
    return ahead <= last_number / 2 ? std::optional{ahead} : std::nullopt;
}

SequenceTracker::Arrival SequenceTracker::put(NotificationMessage& message)
{
    const auto ahead = distance_to(message.sequence_number);
    if (!ahead) {
        return Arrival::Duplicate;
    }
    if (*ahead > max_missing_) {
        return Arrival::TooFar;
    }
    const std::uint64_t position = position_ + *ahead;
    end_ = std::max(end_, position + 1);
    return kept_.emplace(position, std::move(message)).second ? Arrival::Kept : Arrival::Repeated;
}

std::optional<NotificationMessage> SequenceTracker::take()
{
    if (kept_.empty() || kept_.begin()->first != position_) {
        return std::nullopt;
    }
    std::optional<NotificationMessage> message{std::move(kept_.begin()->second)};
    kept_.erase(kept_.begin());
    skip();
    return message;
}

bool SequenceTracker::expect_before(std::uint32_t sequence_number)
{
    const auto ahead = distance_to(sequence_number);
    if (ahead && *ahead > max_missing_) {
        return false;
    }
    end_ = std::max(end_, position_ + ahead.value_or(0));
    return true;
}

bool SequenceTracker::expect_through(std::uint32_t sequence_number)
{
    const auto ahead = distance_to(sequence_number);
    if (ahead && *ahead >= max_missing_) {
        return false;
    }
    end_ = std::max(end_, ahead ? position_ + *ahead + 1 : position_);
    return true;
}

bool SequenceTracker::is_missing() const
{
    return position_ < end_ && (kept_.empty() || kept_.begin()->first != position_);
}

void SequenceTracker::skip()
{
    kept_.erase(position_);
    next_ = next_ == last_number ? 1 : next_ + 1;
    ++position_;
    end_ = std::max(end_, position_);
}

void SequenceTracker::restart(std::uint32_t sequence_number)
{
    kept_.clear();
    next_ = std::max<std::uint32_t>(sequence_number, 1);
    end_ = position_;
}

} // namespace busbar::client::detail
