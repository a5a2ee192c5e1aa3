#include "plc_builder.hpp"

#include <cmath>
#include <limits>
#include <type_traits>

#include <busbar/core/guid.hpp>

#include "server/image/image_types.hpp"

namespace busbar::controller::detail {

namespace {

template <typename T>
inline constexpr bool is_number = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

template <typename T>
std::optional<T> from_integer(std::int64_t value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        return std::in_range<T>(value) ? std::optional{static_cast<T>(value)} : std::nullopt;
    }
}

template <typename T>
std::optional<T> from_double(double value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        constexpr double exact = 9007199254740992.0; // 2^53
        return std::trunc(value) == value && std::abs(value) <= exact
                   ? from_integer<T>(static_cast<std::int64_t>(value))
                   : std::nullopt;
    }
}

template <typename T>
std::optional<T> from_text(const String& text)
{
    if constexpr (std::same_as<T, Guid>) {
        const auto guid = Guid::parse(text.view());
        return guid ? std::optional{*guid} : std::nullopt;
    } else if constexpr (std::same_as<T, ByteString>) {
        const auto view = text.view();
        return ByteString{std::as_bytes(std::span{view.data(), view.size()})};
    } else if constexpr (std::same_as<T, XmlElement>) {
        return XmlElement{text};
    } else {
        return std::nullopt;
    }
}

/// Converts `value`, a scalar or an element, to T.
template <typename T, typename From>
std::optional<T> convert(const From& value)
{
    if constexpr (std::same_as<T, From>) {
        return value;
    } else if constexpr (is_number<T> && std::same_as<From, std::int64_t>) {
        return from_integer<T>(value);
    } else if constexpr (is_number<T> && std::same_as<From, double>) {
        return from_double<T>(value);
    } else if constexpr (std::same_as<From, String>) {
        return from_text<T>(value);
    } else {
        return std::nullopt;
    }
}

template <typename T, typename From>
std::optional<Array<T>> convert_all(std::span<const From> values)
{
    Array<T> result;
    result.reserve(values.size());
    for (const From& value : values) {
        auto converted = convert<T>(value);
        if (!converted) {
            return std::nullopt;
        }
        result.push_back(std::move(*converted));
    }
    return result;
}

/// Converts all elements of `from`, whatever their type, to T.
template <typename T>
std::optional<Array<T>> elements(const Variant& from)
{
    return server::detail::visit_image_type(
        from.type(),
        [&](auto tag) -> std::optional<Array<T>> {
            using From = typename decltype(tag)::type;
            if (const Array<From>* array = from.array_if<From>()) {
                return convert_all<T>(array->span());
            }
            return convert_all<T>(std::span{from.get_if<From>(), 1});
        },
        [] { return std::optional<Array<T>>{}; });
}

template <typename T>
T empty_value()
{
    if constexpr (std::same_as<T, String> || std::same_as<T, XmlElement>) {
        return T{String{""}};
    } else if constexpr (std::same_as<T, ByteString>) {
        return ByteString{std::span<const std::byte>{}};
    } else {
        return T{};
    }
}

template <typename T>
std::optional<Variant> make(const PlcVariable& variable)
{
    const Variant& initial = variable.initial;
    std::optional<Array<T>> values =
        initial.is_null() ? Array<T>{empty_value<T>()} : elements<T>(initial);
    if (!values) {
        return std::nullopt;
    }
    if (variable.dimensions.empty()) {
        return initial.is_array() ? std::nullopt : std::optional{Variant{std::move((*values)[0])}};
    }
    std::size_t count = 1;
    for (const std::uint32_t dimension : variable.dimensions) {
        count *= dimension;
    }
    if (!initial.is_array()) {
        Array<T> filled;
        filled.reserve(count);
        while (filled.size() < count) {
            filled.push_back((*values)[0]);
        }
        values = std::move(filled);
    } else if (values->size() != count ||
               (initial.is_matrix() &&
                !std::ranges::equal(initial.dimensions(), variable.dimensions))) {
        return std::nullopt;
    }
    return Variant::matrix(std::move(*values), Array<std::uint32_t>{variable.dimensions});
}

} // namespace

std::optional<Variant> initial_value(const PlcVariable& variable)
{
    return server::detail::visit_image_type(
        variable.type, [&](auto tag) { return make<typename decltype(tag)::type>(variable); },
        [] { return std::optional<Variant>{}; });
}

} // namespace busbar::controller::detail
