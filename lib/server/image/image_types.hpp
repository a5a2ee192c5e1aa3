#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/server/image_layout.hpp>

namespace busbar::server::detail {

template <typename T>
struct ImageTag {
    using type = T;
};

/// Calls `visit(ImageTag<T>)` for a type that an image can have, else `otherwise()`.
template <typename Visit, typename Otherwise>
auto visit_image_type(BuiltInType type, Visit&& visit, Otherwise&& otherwise)
{
    // clang-format off
    switch (type) {
    case BuiltInType::Boolean: return visit(ImageTag<bool>{});
    case BuiltInType::SByte: return visit(ImageTag<std::int8_t>{});
    case BuiltInType::Byte: return visit(ImageTag<std::uint8_t>{});
    case BuiltInType::Int16: return visit(ImageTag<std::int16_t>{});
    case BuiltInType::UInt16: return visit(ImageTag<std::uint16_t>{});
    case BuiltInType::Int32: return visit(ImageTag<std::int32_t>{});
    case BuiltInType::UInt32: return visit(ImageTag<std::uint32_t>{});
    case BuiltInType::Int64: return visit(ImageTag<std::int64_t>{});
    case BuiltInType::UInt64: return visit(ImageTag<std::uint64_t>{});
    case BuiltInType::Float: return visit(ImageTag<float>{});
    case BuiltInType::Double: return visit(ImageTag<double>{});
    case BuiltInType::String: return visit(ImageTag<String>{});
    case BuiltInType::DateTime: return visit(ImageTag<DateTime>{});
    case BuiltInType::Guid: return visit(ImageTag<Guid>{});
    case BuiltInType::ByteString: return visit(ImageTag<ByteString>{});
    case BuiltInType::XmlElement: return visit(ImageTag<XmlElement>{});
    case BuiltInType::StatusCode: return visit(ImageTag<StatusCode>{});
    default: return otherwise();
    }
    // clang-format on
}

/// Returns the bytes of a text at `from`; nothing if it is null, or longer than `capacity`, which
/// happens only if code writes to the memory directly.
[[nodiscard]] BUSBAR_API std::optional<std::string_view> text_at(const std::byte* from,
                                                                 std::uint32_t capacity);

template <typename T>
[[nodiscard]] std::optional<std::string_view> text_of(const T& text)
{
    if (text.is_null()) {
        return std::nullopt;
    }
    if constexpr (std::same_as<T, ByteString>) {
        return std::string_view{reinterpret_cast<const char*>(text.span().data()), text.size()};
    } else {
        return text.view();
    }
}

/// Returns whether a text of these bytes of UTF-8 has room in the place.
[[nodiscard]] BUSBAR_API bool has_room(const ImagePlace& place, std::string_view text);

/// Returns whether a value has room in the place; null has.
template <typename T>
[[nodiscard]] bool text_has_room(const ImagePlace& place, const T& value)
{
    const auto text = text_of(value);
    return !text || has_room(place, *text);
}

/// Stores a text at `to`, which must have enough room. It may be the text that is already there.
BUSBAR_API void put_text(std::byte* to, std::optional<std::string_view> text);

/// Returns a String, ByteString or XmlElement that points at the text at `from`.
template <typename T>
[[nodiscard]] T borrow_text(const std::byte* from, std::uint32_t capacity)
{
    const auto text = text_at(from, capacity);
    if (!text) {
        return T{};
    }
    if constexpr (std::same_as<T, ByteString>) {
        return ByteString::borrow(std::as_bytes(std::span{text->data(), text->size()}));
    } else {
        return T{String::borrow(*text)};
    }
}

/// Returns whether the place's range allows this value.
template <typename T>
[[nodiscard]] bool is_in_range(const ImagePlace& place, T value)
{
    if constexpr (std::integral<T> && !std::same_as<T, bool>) {
        return !place.range || (std::cmp_less_equal(place.range->lower, value) &&
                                std::cmp_less_equal(value, place.range->upper));
    } else {
        return true;
    }
}

/// Returns Good if `value` has the place's type, dimensions, text capacity and range. Does not
/// check the content of structures.
[[nodiscard]] StatusCode check_value(const ImagePlace& place, const Variant& value);

/// Returns the bytes of the elements of a Variant of numbers; valid as long as that.
[[nodiscard]] std::span<const std::byte> number_bytes(const Variant& value);

} // namespace busbar::server::detail
