#pragma once

namespace busbar::detail {

/// Has the memory at `address` brought near, and goes on without waiting for it. Any address is
/// allowed.
inline void fetch(const void* address)
{
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    static_cast<void>(address);
#endif
}

} // namespace busbar::detail
