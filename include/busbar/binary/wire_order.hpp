#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace busbar::detail {

/// A type whose values are one number of fixed size on the wire.
template <typename T>
concept WireNumber = (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) || std::is_enum_v<T>;

} // namespace busbar::detail

namespace busbar::binary::detail {

/// Copies a number of `Size` bytes between memory and the wire, where it is little-endian
/// (Part 6, 5.2.2.2 and 5.2.2.3). `Native` is an argument for the tests.
template <std::size_t Size, std::endian Native = std::endian::native>
void copy_number(void* to, const void* from)
{
    static_assert(Native == std::endian::little || Native == std::endian::big);
    if constexpr (Native == std::endian::little || Size == 1) {
        std::memcpy(to, from, Size);
    } else {
        auto* const bytes = static_cast<std::byte*>(to);
        const auto* const reversed = static_cast<const std::byte*>(from) + Size - 1;
        for (std::size_t i = 0; i < Size; ++i) {
            bytes[i] = *(reversed - i);
        }
    }
}

/// The same for `count` numbers, one after the other.
template <std::size_t Size, std::endian Native = std::endian::native>
void copy_numbers(void* to, const void* from, std::size_t count)
{
    if constexpr (Native == std::endian::little || Size == 1) {
        if (count != 0) {
            std::memcpy(to, from, count * Size);
        }
    } else {
        for (std::size_t i = 0; i < count * Size; i += Size) {
            copy_number<Size, Native>(static_cast<std::byte*>(to) + i,
                                      static_cast<const std::byte*>(from) + i);
        }
    }
}

} // namespace busbar::binary::detail
