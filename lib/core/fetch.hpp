#pragma once

#include <cstddef>

namespace busbar::detail {

/// How many of a row are on their way from memory while one is looked at, where each is looked at
/// for some nanoseconds.
inline constexpr std::size_t fetched_ahead = 8;

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
