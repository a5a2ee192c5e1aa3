#include "machine_saver.hpp"

#include <chrono>
#include <utility>

namespace busbar::example {

namespace {

constexpr std::chrono::milliseconds usual_pause{200};
constexpr std::chrono::milliseconds pause_after_error{3'000};

} // namespace

MachineSaver::MachineSaver(std::function<bool()> save)
    : save_{std::move(save)}, thread_{[this] { work(); }}
{
}

MachineSaver::~MachineSaver()
{
    {
        const std::lock_guard lock{mutex_};
        is_ending_ = true;
    }
    ends_.notify_all();
    thread_.join();
}

void MachineSaver::work()
{
    std::unique_lock lock{mutex_};
    while (!is_ending_) {
        lock.unlock();
        const bool is_saved = save_();
        lock.lock();
        ends_.wait_for(lock, is_saved ? usual_pause : pause_after_error,
                       [this] { return is_ending_; });
    }
}

} // namespace busbar::example
