#include <busbar/core/detail/hand_over.hpp>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::detail {

void WakerSlot::set(Waker* waker) noexcept
{
    waker_ = waker;
    while (callers_ != 0) {
        // Those threads are inside Waker::wake, which does not block.
    }
}

void WakerSlot::wake() noexcept
{
    ++callers_;
    if (Waker* const waker = waker_; waker != nullptr) {
        attempt([&] { waker->wake(); });
    }
    callers_.fetch_sub(1, std::memory_order_release);
}

} // namespace busbar::detail
