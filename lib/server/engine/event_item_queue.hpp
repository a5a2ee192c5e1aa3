#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/types.hpp>
#include <busbar/model/node.hpp>

#include "server/subscription/value_queue.hpp"

namespace busbar::server::detail {

/// The queue of an event item (Part 4, 5.13.1.5): up to a number of events and, in addition, the
/// EventQueueOverflowEventType at the place where events were lost, which is never discarded.
class EventItemQueue {
public:
    using Fields = Array<Variant>;

    /// `account` pays for queued events and must outlive the queue.
    explicit EventItemQueue(MemoryAccount& account) : account_{&account} {}
    EventItemQueue(const EventItemQueue&) = delete;
    EventItemQueue& operator=(const EventItemQueue&) = delete;
    ~EventItemQueue() { clear(); }

    /// Returns false if events were lost for lack of room.
    [[nodiscard]] bool set_capacity(std::uint32_t capacity, bool discards_oldest);

    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    /// Queues an event, if necessary in place of the oldest or of the newest. Returns false if one
    /// was lost, which may be this one, if it cannot be paid for. `type` is the type of the event;
    /// `is_guarded`: not every user may read all of its fields.
    [[nodiscard]] bool push(Fields fields, model::NodeIndex type = model::no_node,
                            bool is_guarded = false);
    /// Discards, for another user, the events with such fields and those of types that the user may
    /// not know of; false if there are none.
    [[nodiscard]] bool discard_guarded(FunctionRef<bool(model::NodeIndex type)> may_know_of);
    /// Returns true if a loss needs a new overflow event, since there is none at this place yet.
    [[nodiscard]] bool wants_overflow() const;
    /// Puts the overflow event in its place: in front if the oldest are discarded, else at the end.
    /// The first one is free: items pay for its place when they are created.
    void push_overflow(Fields fields);
    [[nodiscard]] const Fields& oldest() const { return entries_.front().fields; }
    void pop();
    void clear();

private:
    struct Entry {
        Fields fields;
        std::size_t bytes{0};
        bool is_overflow{false};
        bool is_guarded{false};
        model::NodeIndex type{model::no_node};
    };
    [[nodiscard]] std::size_t event_count() const { return entries_.size() - overflow_count_; }
    /// Discards the event that must make room for another.
    void discard();

    MemoryAccount* account_;
    std::deque<Entry> entries_;
    std::size_t overflow_count_{0};
    std::uint32_t capacity_{1};
    bool discards_oldest_{true};
};

} // namespace busbar::server::detail
