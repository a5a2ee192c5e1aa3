#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "timer_queue.hpp"

namespace busbar::server::detail {

class Subscription;

/// Subscriptions that are deleted, until their items are. Items are deleted a few at a time, after
/// all other work that is due: a hundred thousand take longer than any client should wait.
class EndedSubscriptions final : public Timer {
public:
    /// `timers` must outlive this object.
    explicit EndedSubscriptions(TimerQueue& timers);
    ~EndedSubscriptions() override;

    /// Takes one that has neither session nor timer any more.
    void add(std::unique_ptr<Subscription> subscription);
    /// Removes at most this many items; false if there are none.
    bool sweep(std::size_t items) noexcept;
    [[nodiscard]] std::size_t size() const { return all_.size(); }
    void clear();
    void expire(TimePoint now) override;

private:
    TimerQueue& timers_;
    std::vector<std::unique_ptr<Subscription>> all_;
};

} // namespace busbar::server::detail
