#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "timer_queue.hpp"

namespace busbar::server::detail {

class Subscription;

/// Subscriptions that are deleted, until their items are gone. These go a few at a time, when all
/// else that is due is done: a hundred thousand take longer than anybody should have to wait.
class EndedSubscriptions final : public Timer {
public:
    /// `timers` must outlive this object.
    explicit EndedSubscriptions(TimerQueue& timers);
    ~EndedSubscriptions() override;

    /// Takes one that has neither session nor timer any more.
    void add(std::unique_ptr<Subscription> subscription);
    /// Removes that many items at most; false if there is none.
    bool sweep(std::size_t items) noexcept;
    [[nodiscard]] std::size_t size() const { return all_.size(); }
    void clear();
    void expire(TimePoint now) override;

private:
    TimerQueue& timers_;
    std::vector<std::unique_ptr<Subscription>> all_;
};

} // namespace busbar::server::detail
