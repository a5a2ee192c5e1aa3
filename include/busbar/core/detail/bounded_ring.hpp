#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace busbar::detail {

/// Places for items on their way from any thread to the one that takes them, in the order in which
/// the places were taken. Nothing is allocated after the constructor.
///
/// The `turn` of a place says which thread owns it: n is that of the thread that puts the n-th
/// item, which has taken the number by an exchange, so that no other thread has it; n + 1 that of
/// the taker, which passes it on to item n + size. Both store the turn when they are done with the
/// place, and that synchronizes with the load by which the other one finds it.
template <typename T>
class BoundedRing {
public:
    /// Room for `capacity` items, rounded up to a power of two, and two at least.
    explicit BoundedRing(std::size_t capacity)
        : mask_{size_for(capacity) - 1}, places_{std::make_unique<Place[]>(mask_ + 1)}
    {
        for (std::size_t i = 0; i <= mask_; ++i) {
            places_[i].turn = i;
        }
    }
    BoundedRing(const BoundedRing&) = delete;
    BoundedRing& operator=(const BoundedRing&) = delete;

    /// Called from any thread: has `put`, which must not throw, fill a place. False if there is
    /// none.
    template <typename Put>
    [[nodiscard]] bool push(Put put)
    {
        std::size_t number = in_.load();
        while (true) {
            Place& place = places_[number & mask_];
            const auto ahead = static_cast<std::ptrdiff_t>(place.turn.load() - number);
            if (ahead == 0) {
                if (in_.compare_exchange_weak(number, number + 1)) {
                    put(place.item);
                    place.turn.store(number + 1);
                    return true;
                }
            } else if (ahead < 0) {
                return false; // still holds the item of the previous round
            } else {
                number = in_.load();
            }
        }
    }
    /// Called by one thread at a time: has `take`, which must not throw, empty the place of the
    /// oldest item. False if there is none.
    template <typename Take>
    [[nodiscard]] bool take(Take take)
    {
        Place& place = places_[out_ & mask_];
        if (place.turn.load() != out_ + 1) {
            return false;
        }
        take(place.item);
        place.turn.store(out_ + mask_ + 1);
        ++out_;
        return true;
    }

private:
    struct Place {
        std::atomic<std::size_t> turn{0};
        T item{};
    };

    [[nodiscard]] static std::size_t size_for(std::size_t capacity)
    {
        std::size_t size = 2;
        while (size < capacity) {
            size *= 2;
        }
        return size;
    }

    std::size_t mask_;
    std::unique_ptr<Place[]> places_;
    std::atomic<std::size_t> in_{0}; // numbers that threads have taken to put items
    std::size_t out_{0};             // the taker's
};

} // namespace busbar::detail
