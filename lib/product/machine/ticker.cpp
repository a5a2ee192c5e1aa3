#include "ticker.hpp"

#include <utility>

namespace busbar::product {

Ticker::Ticker(Tick tick) : tick_{std::move(tick)}, thread_{[this] { work(); }} {}

Ticker::~Ticker()
{
    {
        const std::lock_guard lock{mutex_};
        is_ending_ = true;
    }
    ends_.notify_all();
    thread_.join();
}

void Ticker::work()
{
    std::unique_lock lock{mutex_};
    while (!is_ending_) {
        lock.unlock();
        const std::chrono::milliseconds pause = tick_();
        lock.lock();
        ends_.wait_for(lock, pause, [this] { return is_ending_; });
    }
}

} // namespace busbar::product
