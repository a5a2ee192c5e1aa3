#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/waker.hpp>

/// Threads hand work over to the one that drives a server: they put it where that thread finds it,
/// in a HandOver, a BoundedRing (bounded_ring.hpp) or a flag, and then a WakerSlot tells it to look
/// there. None of these blocks or allocates, so that a task of the PLC may use them.
///
/// Why this is right, in four steps. (1) What a thread wrote before it put an item is visible to
/// the thread that takes it: each class says which of its operations synchronize. (2) No item is
/// lost or taken twice: a HandOver is taken whole by one exchange, and a place of a BoundedRing has
/// one owner at a time. (3) No item is forgotten: the thread that puts an item either wakes the
/// taker after that, or finds that another thread has yet to do so, or that the taker has yet to
/// look. A flag is set by an exchange, and the thread that finds it clear wakes; the taker clears
/// it before it looks, so that an item which it does not find finds the flag clear. (4) Nothing is
/// used after its end: Lent::set() waits for the threads that use what it replaces.
namespace busbar::detail {

/// An object that any thread uses, and that may go away while others use it.
///
/// All operations but the last of use() are sequentially consistent, so that they have one order.
/// use() counts itself in and then loads the object; set() stores another one and then loads the
/// count. If use() has loaded the object before it was replaced, it was counted in before, too, and
/// set() waits until it has counted itself out; that is a release which set() acquires, so that the
/// use of the object happens before set() returns. If it has loaded it afterwards, it has the other
/// one.
template <typename T>
class Lent {
public:
    explicit Lent(T* object = nullptr) : object_{object} {}
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;

    /// When this returns, the previous object is not in use any more. Called by one thread at a
    /// time, and not inside use(). Calls `pause` while other threads are inside use().
    template <typename Pause>
    void set(T* object, Pause pause)
    {
        object_ = object;
        while (users_ != 0) {
            pause();
        }
    }
    void set(T* object) noexcept
    {
        set(object, [] {});
    }
    [[nodiscard]] bool is_empty() const noexcept { return object_ == nullptr; }
    /// Called from any thread: calls `act` with the object. False if there is none.
    template <typename Act>
    bool use(Act act)
    {
        const User user{users_};
        T* const object = object_;
        if (object == nullptr) {
            return false;
        }
        act(*object);
        return true;
    }

private:
    /// Counts a thread inside use(), however it leaves it.
    class User {
    public:
        explicit User(std::atomic<std::uint32_t>& count) : count_{count} { ++count_; }
        User(const User&) = delete;
        User& operator=(const User&) = delete;
        ~User() { count_.fetch_sub(1, std::memory_order_release); }

    private:
        std::atomic<std::uint32_t>& count_;
    };

    std::atomic<T*> object_;
    std::atomic<std::uint32_t> users_{0};
};

/// The Waker of a thread that may go away while others wake it.
class BUSBAR_API WakerSlot {
public:
    explicit WakerSlot(Waker* waker = nullptr) : waker_{waker} {}
    WakerSlot(const WakerSlot&) = delete;
    WakerSlot& operator=(const WakerSlot&) = delete;

    /// When this returns, the previous Waker is not in use any more. Called by one thread at a
    /// time; waits for threads that are inside Waker::wake, which does not block.
    void set(Waker* waker) noexcept;
    [[nodiscard]] bool is_empty() const noexcept { return waker_.is_empty(); }
    /// Called from any thread: calls the Waker, if there is one. Exceptions of the Waker are
    /// discarded.
    void wake() noexcept;

private:
    Lent<Waker> waker_;
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
