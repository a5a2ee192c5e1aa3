#include "assembly.hpp"

#include <utility>

#include <busbar/channel/spare_buffers.hpp>
#include <busbar/core/text.hpp>

#include "buffer_bounds.hpp"

namespace busbar::channel {

bool AssemblyBudget::take(std::size_t size)
{
    std::size_t left = left_.load(std::memory_order_relaxed);
    while (left >= size) {
        if (left_.compare_exchange_weak(left, left - size, std::memory_order_relaxed)) {
            return true;
        }
    }
    return false;
}

namespace detail {

Result<std::optional<ChannelEvent>> Assembly::add(char flag, const SymmetricContent& content)
{
    // Chunks of two messages are not mixed: a sender finishes one before the next begins.
    if (chunks_ != 0 && content.request_id != request_id_) {
        return fail(status::Bad_TcpMessageTypeInvalid);
    }
    if (flag == 'A') {
        return give_up(content);
    }
    if (chunks_ == max_chunk_count_ || message_.size() + content.body.size() > max_message_size_) {
        return fail(status::Bad_TcpMessageTooLarge);
    }
    if (flag == 'C' && !charge(content.body.size())) {
        return fail(status::Bad_TcpNotEnoughResources);
    }
    if (chunks_ == 0 && spares_ != nullptr) {
        begin(flag, content.body.size());
    }
    message_.insert(message_.end(), content.body.begin(), content.body.end());
    if (flag == 'C') {
        ++chunks_;
        request_id_ = content.request_id;
        return std::nullopt;
    }
    ChannelEvent event{ChannelEvent::Kind::Message, content.request_id, take_message(), {}, {}};
    drop();
    return event;
}

/// The size of a message of several chunks is not known yet.
void Assembly::begin(char flag, std::size_t size)
{
    message_ = spares_->take_message(flag == 'C' ? SpareBuffers::max_kept : size);
}

/// Returns the message in a buffer that fits: it may be kept for long.
std::vector<std::byte> Assembly::take_message()
{
    auto message = std::exchange(message_, {});
    return spares_ != nullptr ? spares_->fitted(std::move(message)) : std::move(message);
}

ChannelEvent Assembly::give_up(const SymmetricContent& content)
{
    drop();
    ChannelEvent event{
        ChannelEvent::Kind::Aborted, content.request_id, {}, status::Bad_DecodingError, {}};
    const auto message = parse_error(content.body);
    if (message && message->error.is_bad()) {
        event.status = message->error;
        event.reason = printable(message->reason.view());
    }
    return event;
}

bool Assembly::charge(std::size_t size)
{
    if (budget_ != nullptr && !budget_->take(size)) {
        return false;
    }
    charged_ += size;
    return true;
}

void Assembly::drop()
{
    if (budget_ != nullptr) {
        budget_->give_back(charged_);
    }
    charged_ = 0;
    chunks_ = 0;
    recycle(std::exchange(message_, {}));
}

void Assembly::recycle(std::vector<std::byte> buffer)
{
    if (spares_ != nullptr) {
        spares_->give_back_message(std::move(buffer));
    } else if (chunks_ == 0 && buffer.capacity() > message_.capacity() &&
               buffer.capacity() <= max_recycled_size) {
        message_ = std::move(buffer);
        message_.clear();
    }
}

} // namespace detail

} // namespace busbar::channel
