#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/waker.hpp>

/// Threads hand work over to the one that drives a server: they put it where that thread finds it,
/// in a HandOver or a flag, and then a WakerSlot tells it to look there. Neither blocks nor
/// allocates, so that a task of the PLC may use them.
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

    /// When this returns, the previous Waker is not in use any more. Called by one thread at a
    /// time; waits for threads that are inside Waker::wake, which does not block.
    void set(Waker* waker) noexcept;
    [[nodiscard]] bool is_empty() const noexcept { return waker_ == nullptr; }
    /// Called from any thread: calls the Waker, if there is one. Exceptions of the Waker are
    /// discarded.
    void wake() noexcept;

private:
    std::atomic<Waker*> waker_;
    std::atomic<std::uint32_t> callers_{0};
};

/// Items on their way from any thread to the one that takes them, in the order in which they were
/// pushed. They are chained by their own member `next`, a T* or a std::unique_ptr<T> that is null
/// when they are pushed. Meanwhile they belong to the HandOver, whose owner takes and frees the
/// rest. It has no bound of its own: items are charged for where they are made.
///
/// The items are a stack that is only ever taken whole. Push does not look at the item that it
/// finds on top, so that it does no harm if that was taken and pushed again meanwhile. The exchange
/// of push synchronizes with that of take(): what a thread did to an item before pushing it happens
/// before the other thread has it.
///
/// Only a push onto an empty stack has to be followed by a wake. Any other item lies on one that
/// had not been taken, and at the bottom lies one whose push was followed by a wake: the take()
/// that gets that one, because of its wake or before it, gets all items above it.
template <typename T>
class HandOver {
public:
    HandOver() = default;
    HandOver(const HandOver&) = delete;
    HandOver& operator=(const HandOver&) = delete;

    /// Called from any thread. Returns true if it was empty: the taker has to be woken.
    bool push(T& item) noexcept
    {
        T* before = newest_.load();
        do {
            static_cast<void>(exchange_next(item, before));
        } while (!newest_.compare_exchange_weak(before, &item));
        return before == nullptr;
    }
    /// Takes all items, the oldest first, each with the following one as its `next`; null if there
    /// are none.
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
