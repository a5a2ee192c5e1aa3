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

/// The same for so many bytes from there on.
inline void fetch(const void* address, std::size_t size)
{
    constexpr std::size_t line_size = 64;
    const auto* const begin = static_cast<const char*>(address);
    for (std::size_t at = 0; at < size; at += line_size) {
        fetch(begin + at);
    }
    fetch(begin + size - 1); // it need not begin where a line does
}

/// The same for all of an object.
template <typename T>
void fetch_object(const T& object)
{
    fetch(&object, sizeof object);
}

} // namespace busbar::detail
