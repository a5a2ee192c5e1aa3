#include "event_item_queue.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

namespace {

std::size_t bytes_of(const EventItemQueue::Fields& fields)
{
    std::size_t bytes = fields.size() * sizeof(Variant) + 64;
    for (const Variant& field : fields) {
        bytes += held_bytes(field);
    }
    return bytes;
}

} // namespace

bool EventItemQueue::set_capacity(std::uint32_t capacity, bool discards_oldest)
{
    capacity_ = std::max(capacity, 1U);
    discards_oldest_ = discards_oldest;
    const bool loses = event_count() > capacity_;
    while (event_count() > capacity_) {
        discard();
    }
    return !loses;
}

bool EventItemQueue::push(Fields fields, model::NodeIndex type, bool is_guarded)
{
    const std::size_t bytes = bytes_of(fields);
    const bool is_full = event_count() == capacity_;
    if (is_full) {
        discard();
    }
    if (!account_->charge(bytes)) {
        return false;
    }
    busbar::detail::Undo undo{[&] { account_->release(bytes); }};
    // After an overflow event at the end only if there is room again: it reports a loss before this
    // event, or one that includes this event.
    const bool is_behind =
        !is_full || discards_oldest_ || entries_.empty() || !entries_.back().is_overflow;
    entries_.insert(is_behind ? entries_.end() : entries_.end() - 1,
                    Entry{std::move(fields), bytes, false, is_guarded, type});
    undo.keep();
    return !is_full;
}

void EventItemQueue::discard()
{
    const auto is_event = [](const Entry& entry) { return !entry.is_overflow; };
    const auto found = discards_oldest_
                           ? std::find_if(entries_.begin(), entries_.end(), is_event)
                           : std::find_if(entries_.rbegin(), entries_.rend(), is_event).base() - 1;
    account_->release(found->bytes);
    entries_.erase(found);
}

bool EventItemQueue::discard_guarded(FunctionRef<bool(model::NodeIndex type)> may_know_of)
{
    const std::size_t discarded = std::erase_if(entries_, [&](const Entry& entry) {
        const bool is_hidden = entry.is_guarded || (!entry.is_overflow && !may_know_of(entry.type));
        if (is_hidden) {
            account_->release(entry.bytes);
        }
        return is_hidden;
    });
    return discarded != 0;
}

bool EventItemQueue::wants_overflow() const
{
    return entries_.empty() || !(discards_oldest_ ? entries_.front() : entries_.back()).is_overflow;
}

void EventItemQueue::push_overflow(Fields fields)
{
    const std::size_t bytes = overflow_count_ == 0 ? 0 : bytes_of(fields);
    if (!account_->charge(bytes)) {
        return; // another one in the queue reports the loss already
    }
    busbar::detail::Undo undo{[&] { account_->release(bytes); }};
    entries_.insert(discards_oldest_ ? entries_.begin() : entries_.end(),
                    Entry{std::move(fields), bytes, true, false, model::no_node});
    undo.keep();
    ++overflow_count_;
}

void EventItemQueue::pop()
{
    const Entry& entry = entries_.front();
    overflow_count_ -= entry.is_overflow ? 1 : 0;
    account_->release(entry.bytes);
    entries_.pop_front();
}

void EventItemQueue::clear()
{
    while (!entries_.empty()) {
        pop();
    }
}

} // namespace busbar::server::detail
