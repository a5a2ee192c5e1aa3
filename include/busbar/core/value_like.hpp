#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include <busbar/core/string.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

namespace detail {

/// A type of texts other than String, such as std::string.
template <typename T>
concept Text = !std::convertible_to<T, Variant> && std::convertible_to<const T&, std::string_view>;

/// A container other than Array, such as std::vector, of values of a built-in type or of texts.
template <typename T>
concept ListOfValues = !std::convertible_to<T, Variant> && !Text<T> && requires(const T& list)
{
    typename T::value_type;
    list.begin();
    list.end();
    requires BuiltIn<typename T::value_type> || Text<typename T::value_type>;
};

} // namespace detail

/// A type whose values can be that of a Variable: everything that a Variant can be made of, texts
/// such as std::string, and containers such as std::vector of texts or of a built-in type.
template <typename T>
concept ValueLike = std::convertible_to<T, Variant> || detail::Text<T> || detail::ListOfValues<T>;

namespace detail {

/// Returns the value as a Variant; copies texts and the elements of containers. An empty container
/// is an empty array, not null.
template <ValueLike T>
[[nodiscard]] Variant variant_of(T value)
{
    if constexpr (Text<T>) {
        return String{std::string_view{value}};
    } else if constexpr (ListOfValues<T>) {
        using Given = typename T::value_type;
        using Element = std::conditional_t<BuiltIn<Given>, Given, String>;
        Array<Element> array;
        array.resize(0);
        for (const auto& each : value) {
            array.push_back(Element(each));
        }
        return array;
    } else {
        return value;
    }
}

} // namespace detail

} // namespace busbar
