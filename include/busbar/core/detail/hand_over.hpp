#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/waker.hpp>

/// How threads hand things over to the one that drives a server: what is handed over is put where
/// that finds it, in a HandOver or a flag, and then a WakerSlot tells it to look there. Neither
/// blocks nor allocates, so that a task of the PLC may do it.
namespace busbar::detail {

/// The Waker of a thread that may go away while others wake it.
///
/// All operations but the last of wake() are sequentially consistent, so that they have one order.
/// wake() counts itself in and then loads the Waker; set() stores another one and then loads the
/// count. If wake() has loaded the Waker before it was replaced, it was counted in before, too, and
/// set() waits until it has counted itself out; that is a release which set() acquires, so that the
/// use of the Waker happens before set() returns. If it has loaded it afterwards, it has the other
/// one.
class BUSBAR_API WakerSlot {
public:
    explicit WakerSlot(Waker* waker = nullptr) : waker_{waker} {}
    WakerSlot(const WakerSlot&) = delete;
    WakerSlot& operator=(const WakerSlot&) = delete;

    /// When this returns, the Waker that was there before is not in use any more. One thread at a
    /// time; waits for those who are inside of Waker::wake, which does not block.
    void set(Waker* waker) noexcept;
    [[nodiscard]] bool is_empty() const noexcept { return waker_ == nullptr; }
    /// From any thread: calls the Waker, if there is one. What that throws is lost.
    void wake() noexcept;

private:
    std::atomic<Waker*> waker_;
    std::atomic<std::uint32_t> callers_{0};
};

/// Things on their way from any thread to the one that takes them, in the order in which they were
/// pushed. They are chained by their own member `next`, a T* or a std::unique_ptr<T> that is null
/// when they are pushed, and belong to the HandOver meanwhile, whose owner takes and frees what is
/// left. It has no bound of its own: things are charged for where they are made.
///
/// The items are a stack that is only ever taken whole. Push does not look at the item that it
/// finds on top, so that it does no harm if that was taken and pushed again meanwhile. The exchange
/// of push synchronizes with that of take(): what a thread did to an item before it pushed it
/// happens before the other has it.
///
/// Only a push that finds nothing has to be followed by a wake. Any other item was put on one that
/// had not been taken, and that in the end on one that was followed by a wake: the take() which
/// gets that one, because of its wake or before, gets all that was put on it.
template <typename T>
class HandOver {
public:
    HandOver() = default;
    HandOver(const HandOver&) = delete;
    HandOver& operator=(const HandOver&) = delete;

    /// From any thread. True if it was empty: the taker has to be woken.
    bool push(T& item) noexcept
    {
        T* before = newest_.load();
        do {
            static_cast<void>(exchange_next(item, before));
        } while (!newest_.compare_exchange_weak(before, &item));
        return before == nullptr;
    }
    /// All that was pushed, the oldest first, each with the one after it as its `next`; null if
    /// there is nothing.
    [[nodiscard]] T* take() noexcept
    {
        T* newest = newest_.exchange(nullptr);
        T* oldest = nullptr;
        while (newest != nullptr) {
            T* const before = exchange_next(*newest, oldest);
            oldest = std::exchange(newest, before);
        }
        return oldest;
    }

private:
    static T* exchange_next(T& item, T* next) noexcept
    {
        if constexpr (requires { item.next.release(); }) {
            T* const before = item.next.release();
            item.next.reset(next);
            return before;
        } else {
            return std::exchange(item.next, next);
        }
    }

    std::atomic<T*> newest_{nullptr};
};

} // namespace busbar::detail
