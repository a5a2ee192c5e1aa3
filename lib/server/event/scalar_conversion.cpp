#include "filter_conversion.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include <busbar/core/text_forms.hpp>

#include "core/number_text.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::server::detail {

namespace {

template <typename T>
inline constexpr bool is_number = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;

/// Numbers that do not fit are not converted; fractions are rounded.
template <typename To, typename From>
Variant to_number(From value)
{
    if constexpr (std::is_floating_point_v<To>) {
        const auto converted = static_cast<To>(value);
        if constexpr (std::is_same_v<From, double>) {
            if (std::isinf(converted) && !std::isinf(value)) {
                return {};
            }
        }
        return converted;
    } else if constexpr (std::is_floating_point_v<From>) {
        const double rounded = std::round(static_cast<double>(value));
        // The limits are powers of two, or one less, and so exact or one too large.
        const bool fits = rounded >= static_cast<double>(std::numeric_limits<To>::min()) &&
                          rounded < std::ldexp(1.0, std::numeric_limits<To>::digits);
        return fits ? Variant{static_cast<To>(rounded)} : Variant{};
    } else {
        return std::in_range<To>(value) ? Variant{static_cast<To>(value)} : Variant{};
    }
}

template <typename From>
String to_text(From value)
{
    std::array<char, 64> buffer{};
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return String{
        std::string_view{buffer.data(), static_cast<std::size_t>(result.ptr - buffer.data())}};
}

/// StatusCodes are numbers of 32 bits, whose upper half is converted to and from UInt16 (Part 4,
/// 7.7.3).
template <typename From>
Variant to_status(From value)
{
    if constexpr (std::is_same_v<From, std::uint16_t>) {
        return StatusCode{std::uint32_t{value} << 16U};
    } else if constexpr (std::is_same_v<From, std::int32_t>) {
        return StatusCode{std::bit_cast<std::uint32_t>(value)};
    } else {
        const Variant bits = to_number<std::uint32_t>(value);
        return bits.is_null() ? Variant{} : Variant{StatusCode{*bits.get_if<std::uint32_t>()}};
    }
}

template <typename From>
Variant convert_number(From value, BuiltInType to)
{
    return busbar::detail::visit_built_in(to, [&](auto tag) -> Variant {
        using To = typename decltype(tag)::type;
        if constexpr (std::is_same_v<To, bool>) {
            return value != From{};
        } else if constexpr (is_number<To>) {
            return to_number<To>(value);
        } else if constexpr (std::is_same_v<To, String>) {
            return to_text(value);
        } else if constexpr (std::is_same_v<To, StatusCode>) {
            return to_status(value);
        } else {
            return {};
        }
    });
}

Variant convert_boolean(bool value, BuiltInType to)
{
    return to == BuiltInType::String ? Variant{value ? "true" : "false"}
                                     : convert_number(static_cast<std::uint8_t>(value), to);
}

Variant convert_status(StatusCode value, BuiltInType to)
{
    switch (to) {
    case BuiltInType::UInt16:
        return static_cast<std::uint16_t>(value.value() >> 16U);
    case BuiltInType::Int32:
        return std::bit_cast<std::int32_t>(value.value());
    default:
        return convert_number(value.value(), to);
    }
}

/// Reads "true", "false", "1" or "0" in either case.
Variant parse_boolean(std::string_view text)
{
    const auto is = [text](std::string_view word) {
        return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                          [](char a, char b) { return (a | 0x20) == b; });
    };
    if (text == "1" || is("true")) {
        return true;
    }
    return text == "0" || is("false") ? Variant{false} : Variant{};
}

template <typename To>
Variant parse_number(std::string_view text)
{
    if (text.starts_with('+') && !text.starts_with("+-")) {
        text.remove_prefix(1);
    }
    To value{};
    const auto [end, error] =
        busbar::detail::read_number(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() ? Variant{value} : Variant{};
}

template <typename T>
Variant value_or_null(T&& parsed)
{
    return parsed ? Variant{*std::forward<T>(parsed)} : Variant{};
}

Variant convert_text(const String& value, BuiltInType to)
{
    const std::string_view text = value.view();
    return busbar::detail::visit_built_in(to, [&](auto tag) -> Variant {
        using To = typename decltype(tag)::type;
        if constexpr (std::is_same_v<To, bool>) {
            return parse_boolean(text);
        } else if constexpr (is_number<To>) {
            return parse_number<To>(text);
        } else if constexpr (std::is_same_v<To, Guid> || std::is_same_v<To, NodeId>) {
            return value_or_null(To::parse(text));
        } else if constexpr (std::is_same_v<To, DateTime>) {
            return value_or_null(parse_date_time(text));
        } else if constexpr (std::is_same_v<To, ExpandedNodeId>) {
            return value_or_null(parse_expanded_node_id(text));
        } else if constexpr (std::is_same_v<To, QualifiedName>) {
            return QualifiedName{0, value};
        } else if constexpr (std::is_same_v<To, LocalizedText>) {
            return LocalizedText{value};
        } else {
            return {};
        }
    });
}

/// Returns a Guid in the encoding of Part 6, 5.2.2.6: its numbers little-endian.
ByteString to_bytes(const Guid& guid)
{
    std::array<std::byte, 16> bytes{};
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[i] = static_cast<std::byte>(guid.data1 >> (8 * i));
    }
    for (std::size_t i = 0; i < 2; ++i) {
        bytes[4 + i] = static_cast<std::byte>(guid.data2 >> (8 * i));
        bytes[6 + i] = static_cast<std::byte>(guid.data3 >> (8 * i));
    }
    std::transform(guid.data4.begin(), guid.data4.end(), bytes.begin() + 8,
                   [](std::uint8_t b) { return std::byte{b}; });
    return ByteString{bytes};
}

Variant to_guid(const ByteString& value)
{
    const auto bytes = value.span();
    if (bytes.size() != 16) {
        return {};
    }
    const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
    Guid guid;
    guid.data1 = at(0) | at(1) << 8U | at(2) << 16U | at(3) << 24U;
    guid.data2 = static_cast<std::uint16_t>(at(4) | at(5) << 8U);
    guid.data3 = static_cast<std::uint16_t>(at(6) | at(7) << 8U);
    std::transform(bytes.begin() + 8, bytes.end(), guid.data4.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    return guid;
}

Variant convert_guid(const Guid& value, BuiltInType to)
{
    return to == BuiltInType::ByteString ? Variant{to_bytes(value)}
                                         : Variant{String{to_string(value)}};
}

Variant convert_node_id(const NodeId& value, BuiltInType to)
{
    return to == BuiltInType::ExpandedNodeId ? Variant{ExpandedNodeId{value}}
                                             : Variant{String{to_string(value)}};
}

Variant convert_expanded(const ExpandedNodeId& value, BuiltInType to)
{
    if (to == BuiltInType::String) {
        return String{to_string(value)};
    }
    return value.is_local() ? Variant{value.node_id} : Variant{};
}

Variant convert_name(const QualifiedName& value, BuiltInType to)
{
    return to == BuiltInType::LocalizedText ? Variant{LocalizedText{value.name}}
                                            : Variant{value.name};
}

} // namespace

Variant convert_scalar(const Variant& value, BuiltInType to)
{
    return busbar::detail::visit_built_in(value.type(), [&](auto tag) -> Variant {
        using From = typename decltype(tag)::type;
        const From* const from = value.get_if<From>();
        if (from == nullptr) {
            return {};
        }
        if constexpr (std::is_same_v<From, bool>) {
            return convert_boolean(*from, to);
        } else if constexpr (is_number<From>) {
            return convert_number(*from, to);
        } else if constexpr (std::is_same_v<From, StatusCode>) {
            return convert_status(*from, to);
        } else if constexpr (std::is_same_v<From, String>) {
            return convert_text(*from, to);
        } else if constexpr (std::is_same_v<From, DateTime>) {
            return String{to_string(*from)};
        } else if constexpr (std::is_same_v<From, Guid>) {
            return convert_guid(*from, to);
        } else if constexpr (std::is_same_v<From, ByteString>) {
            return to_guid(*from);
        } else if constexpr (std::is_same_v<From, NodeId>) {
            return convert_node_id(*from, to);
        } else if constexpr (std::is_same_v<From, ExpandedNodeId>) {
            return convert_expanded(*from, to);
        } else if constexpr (std::is_same_v<From, QualifiedName>) {
            return convert_name(*from, to);
        } else if constexpr (std::is_same_v<From, LocalizedText>) {
            return from->text;
        } else {
            return {};
        }
    });
}

} // namespace busbar::server::detail
