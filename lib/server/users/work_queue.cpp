#include "work_queue.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

WorkQueue::WorkQueue(Waker* waker) : done_{std::make_shared<Done>()}
{
    done_->waker.set(waker);
}

WorkQueue::~WorkQueue()
{
    done_->waker.set(nullptr);
}

bool WorkQueue::start(const std::shared_ptr<WorkItem>& item,
                      FunctionRef<bool(std::function<void()>)> run, TimePoint now)
{
    std::function<void()> job{[done = done_] { done->work(); }};
    {
        const std::lock_guard lock{done_->mutex};
        done_->waiting.push_back(item);
        ++done_->jobs;
    }
    // One entry waits for each job.
    busbar::detail::Undo undo{[&] {
        const std::lock_guard lock{done_->mutex};
        --done_->jobs;
        done_->waiting.remove(item);
    }};
    const bool is_begun = run(std::move(job));
    undo.keep();
    if (is_begun) {
        return true;
    }
    Done::Items greediest;
    {
        const std::lock_guard lock{done_->mutex};
        --done_->jobs;
        if (done_->waiting.size() <= done_->jobs) { // in the place of a forgotten one
            return true;
        }
        greediest = done_->take_greediest();
    }
    WorkItem& displaced = *greediest.front();
    if (&displaced != item.get() && displaced.owner != nullptr) {
        displaced.owner->work_displaced(now);
    }
    return &displaced != item.get();
}

void WorkQueue::forget(WorkItem& item)
{
    item.owner = nullptr;
    Done::Items forgotten; // destroyed when the lock is not held any more
    const std::lock_guard lock{done_->mutex};
    const auto found = std::find_if(done_->waiting.begin(), done_->waiting.end(),
                                    [&](const auto& one) { return one.get() == &item; });
    if (found != done_->waiting.end()) {
        forgotten.splice(forgotten.end(), done_->waiting, found);
    }
}

std::size_t WorkQueue::Done::count_from(const WorkItem& item) const
{
    return static_cast<std::size_t>(
        std::count_if(waiting.begin(), waiting.end(),
                      [&](const Item& one) { return one->source == item.source; }));
}

WorkQueue::Done::Items WorkQueue::Done::take_next()
{
    constexpr unsigned most_in_turn = 3;
    const bool has_strangers = std::any_of(waiting.begin(), waiting.end(),
                                           [](const Item& item) { return item->rank == 0; });
    const bool is_strangers_turn = has_strangers && known_in_turn >= most_in_turn;
    const auto order = [&](const Item& item) {
        const unsigned rank = item->rank;
        return std::pair{is_strangers_turn ? rank : ~rank, count_from(*item)};
    };
    const auto next =
        std::min_element(waiting.begin(), waiting.end(),
                         [&](const Item& a, const Item& b) { return order(a) < order(b); });
    Items taken;
    if (next != waiting.end()) {
        known_in_turn = (*next)->rank != 0 && has_strangers ? known_in_turn + 1 : 0;
        taken.splice(taken.end(), waiting, next);
    }
    return taken;
}

WorkQueue::Done::Items WorkQueue::Done::take_greediest()
{
    const auto order = [&](const Item& item) { return std::pair{~item->rank, count_from(*item)}; };
    const auto most =
        std::max_element(waiting.rbegin(), waiting.rend(), // the first of equals: the newest
                         [&](const Item& a, const Item& b) { return order(a) < order(b); });
    Items taken;
    taken.splice(taken.end(), waiting, std::next(most).base());
    return taken;
}

void WorkQueue::Done::work()
{
    Items taken;
    {
        const std::lock_guard lock{mutex};
        --jobs;
        taken = take_next();
    }
    if (taken.empty()) {
        return;
    }
    busbar::detail::attempt([&] { taken.front()->run(); });
    {
        const std::lock_guard lock{mutex};
        done.splice(done.end(), taken);
    }
    waker.wake();
}

bool WorkQueue::drain(TimePoint now)
{
    bool is_any_done = false;
    while (const auto item = take_done()) {
        is_any_done = true;
        if (item->owner != nullptr) {
            item->owner->work_done(now);
        }
    }
    return is_any_done;
}

std::shared_ptr<WorkItem> WorkQueue::take_done()
{
    const std::lock_guard lock{done_->mutex};
    if (done_->done.empty()) {
        return nullptr;
    }
    auto item = std::move(done_->done.front());
    done_->done.pop_front();
    return item;
}

} // namespace busbar::server::detail
