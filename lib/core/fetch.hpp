#pragma once

#include <cstddef>

namespace busbar::detail {

/// Number of elements of a row that are prefetched while one is processed, if each takes some
/// nanoseconds.
inline constexpr std::size_t fetched_ahead = 8;

/// Prefetches the memory at `address` without waiting for it. Any address is allowed.
inline void fetch(const void* address)
{
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    static_cast<void>(address);
#endif
}

/// Prefetches `size` bytes from there on.
inline void fetch(const void* address, std::size_t size)
{
    constexpr std::size_t line_size = 64;
    const auto* const begin = static_cast<const char*>(address);
    for (std::size_t at = 0; at < size; at += line_size) {
        fetch(begin + at);
    }
    fetch(begin + size - 1); // the range need not begin at a cache line
}

/// Prefetches a whole object.
template <typename T>
void fetch_object(const T& object)
{
    fetch(&object, sizeof object);
}

} // namespace busbar::detail
