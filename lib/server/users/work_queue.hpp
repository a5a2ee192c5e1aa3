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

/// Who waits for work; lives on the server's thread.
class WorkOwner {
public:
    WorkOwner() = default;
    WorkOwner(const WorkOwner&) = delete;
    WorkOwner& operator=(const WorkOwner&) = delete;

    virtual void work_done(TimePoint now) = 0;
    /// It will not be done: others, who have asked for less, took its place.
    virtual void work_displaced(TimePoint now) = 0;

protected:
    ~WorkOwner() = default;
};

/// Slow work of a peer on its way through a Worker.
class WorkItem {
public:
    WorkItem() = default;
    WorkItem(const WorkItem&) = delete;
    WorkItem& operator=(const WorkItem&) = delete;
    virtual ~WorkItem() = default;

    /// Does it, on any thread; keeps what goes wrong, since nobody else does.
    virtual void run() = 0;

    /// Where it comes from, and how much is known of who is there: nothing of strangers, who are 0.
    std::string source{};
    unsigned rank{0};
    /// Only touched on the server's thread; null if nobody waits any more.
    WorkOwner* owner{nullptr};
};

/// Work that workers do. Lives on the server's thread.
///
/// The worker decides how much waits, this which is next: what has the higher rank, though every
/// fourth is a stranger's; of one rank the sources that have fewest waiting before the others. When
/// there is no room for one more, the last of the lowest rank's source that has most waiting goes.
class WorkQueue {
public:
    /// `waker` may be null; it must be valid as long as this.
    explicit WorkQueue(Waker* waker);
    WorkQueue(const WorkQueue&) = delete;
    WorkQueue& operator=(const WorkQueue&) = delete;
    ~WorkQueue();

    /// False if there is no way back from a worker.
    [[nodiscard]] bool has_way_back() const { return !done_->waker.is_empty(); }
    /// Has a worker do it by `run`, which is Worker::run; its owner is told later. False if there
    /// is no room and nobody else has more waiting.
    [[nodiscard]] bool start(const std::shared_ptr<WorkItem>& item,
                             FunctionRef<bool(std::function<void()>)> run, TimePoint now);
    /// Nobody waits for it any more: it is not begun, and its owner not told.
    void forget(WorkItem& item);
    /// Tells the owners of work that is done. False if there was none.
    bool drain(TimePoint now);

private:
    /// Outlives the server if a worker is late.
    struct Done {
        using Item = std::shared_ptr<WorkItem>;
        /// Moved from one to the other, so that a worker never needs memory for that.
        using Items = std::list<Item>;

        void work();
        /// Takes out what is to be done next; none if nothing waits.
        [[nodiscard]] Items take_next();
        /// Takes out what is not to be done.
        [[nodiscard]] Items take_greediest();
        [[nodiscard]] std::size_t count_from(const WorkItem& item) const;

        busbar::detail::WakerSlot waker;
        std::mutex mutex; // of what follows
        /// The oldest first.
        Items waiting;
        /// Jobs that the worker has not begun: not fewer than wait, as some was forgotten.
        std::size_t jobs{0};
        /// What had its turn while strangers waited.
        unsigned known_in_turn{0};
        Items done;
    };
    /// The next that is done; null if there is none.
    [[nodiscard]] std::shared_ptr<WorkItem> take_done();

    std::shared_ptr<Done> done_;
};

} // namespace busbar::server::detail
