#include <busbar/server/event.hpp>

#include <bit>

namespace busbar::server {

/// Bounded queue of many writers and one reader: `turn` says whose turn a slot is. It is n for the
/// writer of the n-th event and n + 1 for its reader, who then leaves it to event n + size.
struct EventQueue::Slot {
    std::atomic<std::size_t> turn{0};
    Event event;
};

EventQueue::EventQueue(const WallClock& wall_clock, Waker* waker, std::size_t capacity)
    : wall_clock_{&wall_clock}, waker_{waker}, mask_{std::bit_ceil(capacity < 2 ? 2 : capacity) -
                                                     1},
      slots_{std::make_unique<Slot[]>(mask_ + 1)}
{
    for (std::size_t i = 0; i <= mask_; ++i) {
        slots_[i].turn = i;
    }
}

EventQueue::~EventQueue() = default;

bool EventQueue::raise(Event event)
{
    ++raisers_;
    bool is_queued = false;
    if (!is_closed_) {
        if (event.time.is_null()) {
            event.time = wall_clock_->now();
        }
        is_queued = push(event);
        if (!is_queued) {
            ++dropped_;
        }
        // Clients are told of a lost event too.
        if (!is_awake_.exchange(true) && waker_ != nullptr) {
            waker_->wake();
        }
    }
    --raisers_;
    return is_queued;
}

bool EventQueue::push(Event& event)
{
    std::size_t place = in_.load();
    while (true) {
        Slot& slot = slots_[place & mask_];
        const auto ahead = static_cast<std::ptrdiff_t>(slot.turn.load() - place);
        if (ahead == 0) {
            if (in_.compare_exchange_weak(place, place + 1)) {
                slot.event = std::move(event);
                slot.turn.store(place + 1);
                return true;
            }
        } else if (ahead < 0) {
            return false; // still holds the event of the round before
        } else {
            place = in_.load();
        }
    }
}

bool EventQueue::next(Event& event)
{
    Slot& slot = slots_[out_ & mask_];
    if (slot.turn.load() != out_ + 1) {
        return false;
    }
    event = std::move(slot.event);
    slot.event = Event{};
    slot.turn.store(out_ + mask_ + 1);
    ++out_;
    return true;
}

void EventQueue::close()
{
    is_closed_ = true;
    while (raisers_ != 0) {
        // A raiser is between its check and the end of Waker::wake, neither of which blocks.
    }
    Event event;
    while (next(event)) {
    }
}

} // namespace busbar::server
