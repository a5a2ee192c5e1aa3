#include <busbar/server/event.hpp>

#include <utility>

namespace busbar::server {

EventQueue::EventQueue(const WallClock& wall_clock, Waker* waker, std::size_t capacity)
    : wall_clock_{&wall_clock}, waker_{waker}, ring_{capacity}
{
}

EventQueue::~EventQueue() = default;

bool EventQueue::raise(Event event)
{
    bool is_queued = false;
    wall_clock_.use([&](const WallClock& wall_clock) {
        if (event.time.is_null()) {
            event.time = wall_clock.now();
        }
        push([&](Raised& raised) { raised.event = std::move(event); }, is_queued);
    });
    return is_queued;
}

bool EventQueue::raise(const std::shared_ptr<const Event>& event, DateTime time)
{
    bool is_queued = false;
    wall_clock_.use([&](const WallClock&) {
        push(
            [&](Raised& raised) {
                raised.made = event;
                raised.time = time;
            },
            is_queued);
    });
    return is_queued;
}

/// `put` fills the place in the ring, if there is one.
template <typename Put>
void EventQueue::push(Put put, bool& is_queued)
{
    is_queued = ring_.push(put);
    if (!is_queued) {
        ++dropped_;
    }
    // Clients are told of a lost event too.
    if (!is_awake_.exchange(true)) {
        waker_.wake();
    }
}

bool EventQueue::next(Event& event)
{
    Raised raised;
    if (!ring_.take([&](Raised& oldest) { raised = std::exchange(oldest, {}); })) {
        return false;
    }
    event = std::move(raised.event);
    if (raised.made != nullptr) { // copying needs memory: the place is free even if that fails
        event = *raised.made;
        event.time = raised.time;
    }
    return true;
}

void EventQueue::close()
{
    wall_clock_.set(nullptr); // waits for threads that raise an event, none of which blocks
    waker_.set(nullptr);
    Event event;
    while (next(event)) {
    }
}

} // namespace busbar::server
