#include "retransmission_queue.hpp"

#include <algorithm>
#include <utility>

namespace busbar::server::detail {

void RetransmissionQueue::make_place()
{
    constexpr std::size_t first = 4;
    const std::size_t most = std::max<std::size_t>(max_messages_, 1);
    if (messages_.size() == messages_.capacity() && messages_.size() < most) {
        messages_.reserve(std::min(std::max(2 * messages_.size(), first), most));
    }
}

void RetransmissionQueue::drop_oldest()
{
    account_->release(messages_.front().bytes.capacity());
    messages_.erase(messages_.begin());
}

std::uint32_t RetransmissionQueue::add(std::uint32_t sequence_number,
                                       std::vector<std::byte>& message)
{
    std::uint32_t lost = 0;
    for (; messages_.size() >= max_messages_ && !messages_.empty(); ++lost) {
        drop_oldest();
    }
    for (; !account_->charge(message.capacity()); ++lost) {
        if (messages_.empty()) {
            return lost + 1;
        }
        drop_oldest();
    }
    messages_.push_back({sequence_number, std::move(message)});
    return lost;
}

bool RetransmissionQueue::acknowledge(std::uint32_t sequence_number)
{
    const auto found =
        std::find_if(messages_.begin(), messages_.end(), [&](const Message& message) {
            return message.sequence_number == sequence_number;
        });
    if (found == messages_.end()) {
        return false;
    }
    account_->release(found->bytes.capacity());
    messages_.erase(found);
    return true;
}

const std::vector<std::byte>* RetransmissionQueue::find(std::uint32_t sequence_number) const
{
    const auto found =
        std::find_if(messages_.begin(), messages_.end(), [&](const Message& message) {
            return message.sequence_number == sequence_number;
        });
    return found != messages_.end() ? &found->bytes : nullptr;
}

void RetransmissionQueue::encode_available(binary::Writer& writer) const
{
    writer.length(messages_.size());
    for (const Message& message : messages_) {
        writer.number(message.sequence_number);
    }
}

std::vector<std::uint32_t> RetransmissionQueue::available() const
{
    std::vector<std::uint32_t> numbers;
    for (const Message& message : messages_) {
        numbers.push_back(message.sequence_number);
    }
    return numbers;
}

void RetransmissionQueue::clear()
{
    for (const Message& message : messages_) {
        account_->release(message.bytes.capacity());
    }
    messages_.clear();
}

} // namespace busbar::server::detail
