#pragma once

#include <type_traits>

/// Bit operators of generated option sets: enumerations whose values are bits (Part 3, 8.40).
namespace busbar {

/// True for the enumerations that the generator creates for option sets.
template <typename E>
inline constexpr bool is_option_set = false;

template <typename E>
concept OptionSetEnum = std::is_enum_v<E> && is_option_set<E>;

/// The usual operators of sets of bits.
template <OptionSetEnum E>
[[nodiscard]] constexpr E operator|(E a, E b)
{
    using Number = std::underlying_type_t<E>;
    return static_cast<E>(static_cast<Number>(a) | static_cast<Number>(b));
}
template <OptionSetEnum E>
[[nodiscard]] constexpr E operator&(E a, E b)
{
    using Number = std::underlying_type_t<E>;
    return static_cast<E>(static_cast<Number>(a) & static_cast<Number>(b));
}
template <OptionSetEnum E>
[[nodiscard]] constexpr E operator~(E a)
{
    using Number = std::underlying_type_t<E>;
    return static_cast<E>(static_cast<Number>(~static_cast<Number>(a)));
}
template <OptionSetEnum E>
constexpr E& operator|=(E& a, E b)
{
    return a = a | b;
}
template <OptionSetEnum E>
constexpr E& operator&=(E& a, E b)
{
    return a = a & b;
}
/// True if all of `bits` are set.
template <OptionSetEnum E>
[[nodiscard]] constexpr bool has_bits(E value, E bits)
{
    return (value & bits) == bits;
}

} // namespace busbar
