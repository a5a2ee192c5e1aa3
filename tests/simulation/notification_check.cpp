#include "notification_check.hpp"

#include <algorithm>
#include <utility>

namespace busbar::test {

bool CountCheck::receive(std::int64_t number)
{
    const bool is_overflow = std::exchange(is_overflow_, false);
    const auto last = std::exchange(last_, number);
    if (!last || number == *last + 1) {
        return true;
    }
    if (number > *last && is_overflow) {
        return true;
    }
    if (number < *last || gaps_ == 0) {
        return false;
    }
    --gaps_;
    return true;
}

bool SequenceCheck::receive(NotificationMessage message)
{
    const std::uint32_t number = message.sequence_number;
    highest_ = std::max(highest_, number);
    return number >= next_ && waiting_.emplace(number, std::move(message)).second;
}

bool SequenceCheck::receive_keep_alive(std::uint32_t number)
{
    if (number == 0) {
        return false;
    }
    const bool is_next = number > highest_;
    highest_ = std::max(highest_, number - 1);
    return is_next;
}

void SequenceCheck::receive_available(const Array<std::uint32_t>& numbers)
{
    for (const std::uint32_t number : numbers) {
        highest_ = std::max(highest_, number);
    }
}

std::optional<NotificationMessage> SequenceCheck::take()
{
    const auto found = waiting_.find(next_);
    if (found == waiting_.end()) {
        return std::nullopt;
    }
    NotificationMessage message = std::move(found->second);
    waiting_.erase(found);
    ++next_;
    return message;
}

void SequenceCheck::give_up()
{
    must_reach_ = next_ + kept_;
    ++next_;
}

bool SequenceCheck::was_loss_allowed()
{
    return std::exchange(must_reach_, 0U) <= highest_;
}

} // namespace busbar::test
