#include <busbar/core/detail/hand_over.hpp>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::detail {

void WakerSlot::set(Waker* waker) noexcept
{
    waker_.set(waker);
}

void WakerSlot::wake() noexcept
{
    waker_.use([](Waker& waker) { attempt([&] { waker.wake(); }); });
}

} // namespace busbar::detail
