#include <busbar/server/event.hpp>

#include <bit>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server {

/// A bounded queue of many writers and one reader: `turn` says whose turn a slot is. It is n for
/// the writer of the n-th event and n + 1 for its reader, which then passes it to event n + size.
struct EventQueue::Slot {
    std::atomic<std::size_t> turn{0};
    Event event;
    /// Instead of the event: one that was created beforehand, and the time when it occurred.
    std::shared_ptr<const Event> made;
    DateTime time;
};

namespace {

/// Counts the callers inside raise(), however they leave it.
class Raiser {
public:
    explicit Raiser(std::atomic<std::uint32_t>& count) : count_{count} { ++count_; }
    Raiser(const Raiser&) = delete;
    Raiser& operator=(const Raiser&) = delete;
    ~Raiser() { --count_; }

private:
    std::atomic<std::uint32_t>& count_;
};

} // namespace

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
    const Raiser raiser{raisers_}; // for the clock
    if (event.time.is_null() && !is_closed_) {
        event.time = wall_clock_->now();
    }
    return raise_by([&](Slot& slot) { slot.event = std::move(event); });
}

bool EventQueue::raise(const std::shared_ptr<const Event>& event, DateTime time)
{
    return raise_by([&](Slot& slot) {
        slot.made = event;
        slot.time = time;
    });
}

/// `put` fills the place in the queue, if there is one.
template <typename Put>
bool EventQueue::raise_by(Put put)
{
    const Raiser raiser{raisers_};
    bool is_queued = false;
    if (!is_closed_) {
        is_queued = push(put);
        if (!is_queued) {
            ++dropped_;
        }
        // Clients are told of a lost event too.
        if (!is_awake_.exchange(true) && waker_ != nullptr) {
            // The caller cannot do anything about a failure.
            busbar::detail::attempt([this] { waker_->wake(); });
        }
    }
    return is_queued;
}

template <typename Put>
bool EventQueue::push(Put& put)
{
    std::size_t place = in_.load();
    while (true) {
        Slot& slot = slots_[place & mask_];
        const auto ahead = static_cast<std::ptrdiff_t>(slot.turn.load() - place);
        if (ahead == 0) {
            if (in_.compare_exchange_weak(place, place + 1)) {
                put(slot);
                slot.turn.store(place + 1);
                return true;
            }
        } else if (ahead < 0) {
            return false; // still holds the event of the previous round
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
    const auto made = std::exchange(slot.made, nullptr);
    const DateTime time = slot.time;
    event = std::exchange(slot.event, {});
    slot.turn.store(out_ + mask_ + 1);
    ++out_;
    if (made != nullptr) { // copying needs memory: the place becomes free even if that fails
        event = *made;
        event.time = time;
    }
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
