#include <busbar/server/image_memory.hpp>

#include <algorithm>

#include "image_gather.hpp"
#include "image_types.hpp"
#include "structure_codec.hpp"

namespace busbar::server {

namespace detail {

bool has_room(const ImagePlace& place, std::string_view text)
{
    if (text.size() > place.capacity) {
        return false;
    }
    // Sequences of four bytes are two units, all others one.
    const auto units_of = [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte >= 0xF0 ? 2U : (byte & 0xC0U) != 0x80U ? 1U : 0U;
    };
    std::size_t units = 0;
    for (std::size_t i = 0; i < text.size() && place.max_units != 0; ++i) {
        units += units_of(text[i]);
    }
    return units <= place.max_units;
}

std::optional<std::string_view> text_at(const std::byte* from, std::uint32_t capacity)
{
    ImageText head{};
    std::memcpy(&head, from, sizeof head);
    if (head.size == ImageText::null_size || head.size > capacity) {
        return std::nullopt;
    }
    return std::string_view{reinterpret_cast<const char*>(from + sizeof head), head.size};
}

void put_text(std::byte* to, std::optional<std::string_view> text)
{
    const ImageText head{text ? static_cast<std::uint32_t>(text->size()) : ImageText::null_size};
    std::memcpy(to, &head, sizeof head);
    if (text && !text->empty()) {
        std::memmove(to + sizeof head, text->data(), text->size());
    }
}

namespace {

bool has_shape(const ImagePlace& place, const Variant& value)
{
    if (value.type() != place.type || value.is_array() != place.is_array()) {
        return false;
    }
    if (value.is_matrix() || place.dimensions.size() > 1) {
        return std::ranges::equal(value.dimensions(), place.dimensions);
    }
    return !place.is_array() || value.array_size() == place.elements;
}

template <typename T>
bool texts_fit(const ImagePlace& place, const Variant& value)
{
    if (const T* scalar = value.get_if<T>()) {
        return text_has_room(place, *scalar);
    }
    const Array<T>& texts = *value.array_if<T>();
    return std::ranges::all_of(texts.span(),
                               [&](const T& text) { return text_has_room(place, text); });
}

template <typename T>
bool numbers_are_in_range(const ImagePlace& place, const Variant& value)
{
    if (!place.range) {
        return true;
    }
    if (const T* scalar = value.get_if<T>()) {
        return is_in_range(place, *scalar);
    }
    return std::ranges::all_of(value.array_if<T>()->span(),
                               [&](T number) { return is_in_range(place, number); });
}

} // namespace

StatusCode check_value(const ImagePlace& place, const Variant& value)
{
    if (!has_shape(place, value)) {
        return status::Bad_TypeMismatch;
    }
    if (place.is_structure()) {
        return status::Good;
    }
    return visit_image_type(
        place.type,
        [&](auto tag) -> StatusCode {
            using T = typename decltype(tag)::type;
            if constexpr (is_image_text<T>) {
                return texts_fit<T>(place, value) ? status::Good : status::Bad_OutOfRange;
            } else {
                return numbers_are_in_range<T>(place, value) ? status::Good
                                                             : status::Bad_OutOfRange;
            }
        },
        [] { return StatusCode{status::Bad_TypeMismatch}; });
}

std::span<const std::byte> number_bytes(const Variant& value)
{
    return visit_image_type(
        value.type(),
        [&](auto tag) -> std::span<const std::byte> {
            using T = typename decltype(tag)::type;
            if constexpr (is_image_text<T>) {
                return {};
            } else if (const T* scalar = value.get_if<T>()) {
                return std::as_bytes(std::span{scalar, 1});
            } else if (const Array<T>* array = value.array_if<T>()) {
                return std::as_bytes(array->span());
            } else {
                return {};
            }
        },
        [] { return std::span<const std::byte>{}; });
}

} // namespace detail

namespace {

template <typename T>
Variant load_numbers(const ImagePlace& place, const std::byte* from)
{
    if (!place.is_array()) {
        T value{};
        std::memcpy(&value, from, sizeof value);
        return Variant{value};
    }
    Array<T> values(place.elements);
    std::memcpy(values.data(), from, place.bytes());
    return Variant::matrix(std::move(values), Array<std::uint32_t>{place.dimensions});
}

template <typename T>
Variant load_texts(const ImagePlace& place, const std::byte* from)
{
    if (!place.is_array()) {
        const T borrowed = detail::borrow_text<T>(from, place.capacity);
        return Variant{T(borrowed)};
    }
    Array<T> values;
    values.reserve(place.elements);
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        const T borrowed =
            detail::borrow_text<T>(from + std::size_t{i} * place.stride, place.capacity);
        values.push_back(borrowed);
    }
    return Variant::matrix(std::move(values), Array<std::uint32_t>{place.dimensions});
}

/// Leaves `to` unchanged if it fails.
StatusCode store_structures(const ImagePlace& place, const Variant& value, std::byte* to)
{
    const ExtensionObject* const first = place.is_array()
                                             ? value.array_if<ExtensionObject>()->data()
                                             : value.get_if<ExtensionObject>();
    std::vector<std::byte> decoded(place.bytes());
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        const StatusCode status = detail::decode_structure(
            *place.structure, first[i], decoded.data() + std::size_t{i} * place.stride);
        if (!status.is_good()) {
            return status;
        }
    }
    std::memcpy(to, decoded.data(), decoded.size());
    return status::Good;
}

Variant load_structures(const ImagePlace& place, const std::byte* from)
{
    std::vector<std::byte> body(static_cast<std::size_t>(place.structure->max_wire_size()));
    Array<ExtensionObject> values;
    values.reserve(place.elements);
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        const std::size_t size =
            detail::encode_structure(*place.structure, from + std::size_t{i} * place.stride, body);
        values.push_back(ExtensionObject::from_binary(place.structure->encoding_id(),
                                                      ByteString{std::span{body.data(), size}}));
    }
    return place.is_array()
               ? Variant::matrix(std::move(values), Array<std::uint32_t>{place.dimensions})
               : Variant{std::move(values[0])};
}

} // namespace

ImageMemory::ImageMemory(const ImageLayout& layout)
    : layout_{&layout}, plain_{std::make_unique<std::byte[]>(layout.plain_bytes())},
      arrays_{std::make_unique<std::byte[]>(layout.array_bytes())},
      gather_{std::make_shared<const detail::ImageGather>(layout)}
{
    for (const ImagePlace& place : layout.places()) {
        if (place.runtime == nullptr) {
            detail::clear_texts(place, bytes(place));
        }
    }
}

void ImageMemory::gather(std::byte* to) const
{
    gather_->copy(to);
}

std::optional<std::string_view> ImageMemory::text(std::uint32_t handle, std::uint32_t element) const
{
    const ImagePlace& place = (*layout_)[handle];
    return detail::text_at(bytes(place) + std::size_t{element} * place.stride, place.capacity);
}

bool ImageMemory::set_text(std::uint32_t handle, std::optional<std::string_view> text,
                           std::uint32_t element)
{
    const ImagePlace& place = (*layout_)[handle];
    if (text && !detail::has_room(place, *text)) {
        return false;
    }
    detail::put_text(bytes(place) + std::size_t{element} * place.stride, text);
    return true;
}

std::optional<std::string_view> StructureView::text(std::size_t member, std::uint32_t element) const
{
    return detail::text_at(address(member, element), structure_->members()[member].capacity);
}

bool StructureView::set_text(std::size_t member, std::optional<std::string_view> text,
                             std::uint32_t element) const
{
    if (text && !detail::has_room(structure_->members()[member], *text)) {
        return false;
    }
    detail::put_text(address(member, element), text);
    return true;
}

StatusCode ImageMemory::store(std::uint32_t handle, const Variant& value)
{
    const ImagePlace& place = (*layout_)[handle];
    if (const StatusCode checked = detail::check_value(place, value); !checked.is_good()) {
        return checked;
    }
    if (place.is_structure()) {
        return store_structures(place, value, bytes(place));
    }
    if (!place.is_text()) {
        const auto from = detail::number_bytes(value);
        std::memcpy(bytes(place), from.data(), from.size());
        return status::Good;
    }
    detail::visit_image_type(
        place.type,
        [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (detail::is_image_text<T>) {
                const T* first = place.is_array() ? value.array_if<T>()->data() : value.get_if<T>();
                for (std::uint32_t i = 0; i < place.elements; ++i) {
                    set_text(handle, detail::text_of(first[i]), i);
                }
            }
        },
        [] {});
    return status::Good;
}

Variant ImageMemory::load(std::uint32_t handle) const
{
    const ImagePlace& place = (*layout_)[handle];
    if (place.is_structure()) {
        return load_structures(place, bytes(place));
    }
    return detail::visit_image_type(
        place.type,
        [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (detail::is_image_text<T>) {
                return load_texts<T>(place, bytes(place));
            } else {
                return load_numbers<T>(place, bytes(place));
            }
        },
        [] { return Variant{}; });
}

} // namespace busbar::server
