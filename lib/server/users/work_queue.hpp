#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::server::detail {

/// Waits for work; lives on the server's thread.
class WorkOwner {
public:
    WorkOwner() = default;
    WorkOwner(const WorkOwner&) = delete;
    WorkOwner& operator=(const WorkOwner&) = delete;

    virtual void work_done(TimePoint now) = 0;
    /// It will not be done: other work, whose source has less, took its place. Must not throw,
    /// since that would end the other work.
    virtual void work_displaced(TimePoint now) = 0;

protected:
    ~WorkOwner() = default;
};

/// Slow work for a peer on its way through a Worker.
class WorkItem {
public:
    WorkItem() = default;
    WorkItem(const WorkItem&) = delete;
    WorkItem& operator=(const WorkItem&) = delete;
    virtual ~WorkItem() = default;

    /// Does it, on any thread; keeps errors, since no other code does.
    virtual void run() = 0;

    /// The source of the work, and how well it is known: 0 for unknown peers.
    std::string source{};
    unsigned rank{0};
    /// Used on the server's thread only; null if its owner no longer waits.
    WorkOwner* owner{nullptr};
};

/// Work that workers do. Lives on the server's thread.
///
/// The worker limits how much waits, this object chooses the next one: the highest rank first,
/// although every fourth is an unknown peer's; within one rank the sources with the fewest waiting
/// first. If there is no room for one more, the last one of the lowest rank's source with the most
/// waiting is dropped.
class WorkQueue {
public:
    /// `waker` may be null; it must be valid as long as this.
    explicit WorkQueue(Waker* waker);
    WorkQueue(const WorkQueue&) = delete;
    WorkQueue& operator=(const WorkQueue&) = delete;
    ~WorkQueue();

    /// Returns false if a worker cannot report back.
    [[nodiscard]] bool has_way_back() const { return !done_->waker.is_empty(); }
    /// Lets a worker do it by `run`, which is Worker::run; its owner is notified later. False if
    /// there is no room and no other source has more waiting.
    [[nodiscard]] bool start(const std::shared_ptr<WorkItem>& item,
                             FunctionRef<bool(std::function<void()>)> run, TimePoint now);
    /// Drops work whose owner no longer waits: it is not begun, and its owner not notified.
    /// Allocates nothing and does not throw.
    void forget(WorkItem& item);
    /// Notifies the owners of finished work. False if there was none.
    bool drain(TimePoint now);

private:
    /// Outlives the server if a worker is late.
    struct Done {
        using Item = std::shared_ptr<WorkItem>;
        /// Moved from one list to the other, so that a worker never needs memory for that.
        using Items = std::list<Item>;

        void work();
        /// Removes the next work to do; none if nothing waits.
        [[nodiscard]] Items take_next();
        /// Removes the work to be dropped.
        [[nodiscard]] Items take_greediest();
        [[nodiscard]] std::size_t count_from(const WorkItem& item) const;

        busbar::detail::WakerSlot waker;
        std::mutex mutex; // protects the following members
        /// The oldest first.
        Items waiting;
        /// Jobs that the worker has not begun: at least as many as wait, since some were forgotten.
        std::size_t jobs{0};
        /// Number of turns of known peers while unknown ones waited.
        unsigned known_in_turn{0};
        Items done;
    };
    /// Returns the next finished work; null if there is none.
    [[nodiscard]] std::shared_ptr<WorkItem> take_done();

    std::shared_ptr<Done> done_;
};

} // namespace busbar::server::detail
