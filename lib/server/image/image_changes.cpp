#include "image_changes.hpp"

#include <algorithm>
#include <cstring>

#include <busbar/core/detail/guarded.hpp>

#include "core/range_walk.hpp"
#include "image_types.hpp"
#include "structure_codec.hpp"

namespace busbar::server::detail {

namespace {

template <typename T>
std::span<const T> elements_of(const Variant& value)
{
    if (const Array<T>* array = value.array_if<T>()) {
        return array->span();
    }
    if (const T* scalar = value.get_if<T>()) {
        return {scalar, 1};
    }
    return {};
}

/// The box of the range, or why a Write to it is refused. A range must lie inside the array
/// entirely (Part 4, 5.11.4.2).
StatusCode find_box(const ImagePlace& place, const NumericRange& range, busbar::detail::Box& box)
{
    const auto bounds = range.bounds();
    const std::size_t rank = place.dimensions.size();
    if (place.is_text() && bounds.size() == rank + 1) {
        return status::Bad_WriteNotSupported; // a part of a text
    }
    const auto dimensions = rank > 1 ? std::span<const std::uint32_t>{place.dimensions}
                                     : std::span<const std::uint32_t>{};
    if (rank == 0 || !busbar::detail::make_box(bounds, place.elements, dimensions, box)) {
        return status::Bad_IndexRangeNoData;
    }
    for (std::size_t i = 0; i < box.rank; ++i) {
        if (bounds[i].last >= box.size[i]) {
            return status::Bad_IndexRangeNoData;
        }
    }
    return status::Good;
}

bool fits(const busbar::detail::Box& box, const Variant& value, std::size_t elements)
{
    const auto dimensions = value.dimensions();
    return box.elements() == elements &&
           (dimensions.empty() ||
            std::equal(dimensions.begin(), dimensions.end(), box.count.begin(),
                       box.count.begin() + static_cast<std::ptrdiff_t>(box.rank)));
}

} // namespace

ImageChanges::ImageChanges(WriteBatch batch, const ImageSegments& variables)
    : batch_{std::move(batch)}, variables_{&variables}
{
}

bool ImageChanges::is_too_much() const
{
    return changes_.size() > max_changes_ || bytes_.size() > max_bytes_;
}

bool ImageChanges::add_all(std::uint32_t max_changes, std::uint32_t max_bytes)
{
    max_changes_ = max_changes;
    max_bytes_ = max_bytes;
    const auto items = batch_.items();
    const auto results = batch_.results();
    const std::size_t expected = std::min<std::size_t>(items.size(), max_changes);
    items_.reserve(expected);
    changes_.reserve(expected);
    for (std::size_t i = 0; i < items.size() && !is_too_much(); ++i) {
        results[i] = add(items[i]);
        if (results[i].is_good()) {
            items_.push_back({static_cast<std::uint32_t>(i),
                              static_cast<std::uint32_t>(items[i].handle),
                              static_cast<std::uint32_t>(first_of_item_),
                              static_cast<std::uint32_t>(changes_.size() - first_of_item_),
                              {}});
        }
    }
    return !is_too_much();
}

StatusCode ImageChanges::add(const WriteItem& item)
{
    first_of_item_ = changes_.size();
    const std::size_t bytes = bytes_.size();
    const StatusCode status = add_checked(item);
    if (!status.is_good()) {
        changes_.resize(first_of_item_);
        bytes_.resize(bytes);
    }
    return status;
}

StatusCode ImageChanges::add_checked(const WriteItem& item)
{
    const ImagePlace* const place = variables_->find(item.handle);
    if (place == nullptr) {
        return status::Bad_NodeIdUnknown;
    }
    if (place->is_read_only) {
        return status::Bad_NotWritable;
    }
    if (item.data->status != StatusCode{} || !item.data->source_timestamp.is_null()) {
        return status::Bad_WriteNotSupported; // an image has them per scan, not per value
    }
    return item.range == nullptr ? add_whole(*place, item.data->value)
                                 : add_range(*place, *item.range, item.data->value);
}

// These stand before their users: of what only a generic lambda uses, clang 14 makes nothing if it
// comes later.

template <typename T>
StatusCode ImageChanges::add_element(const ImagePlace& place, std::size_t element, const T& value)
{
    if constexpr (std::same_as<T, ExtensionObject>) {
        return decode_structure(*place.structure, value,
                                grow(element * place.stride, place.stride));
    } else if constexpr (is_image_text<T>) {
        const auto text = text_of(value);
        const ImageText head{text ? static_cast<std::uint32_t>(text->size())
                                  : ImageText::null_size};
        const std::size_t size = text ? text->size() : 0;
        std::byte* const to = grow(element * place.stride, sizeof head + size);
        std::memcpy(to, &head, sizeof head);
        if (size != 0) {
            std::memcpy(to + sizeof head, text->data(), size);
        }
    } else {
        std::memcpy(grow(element * place.stride, sizeof(T)), &value, sizeof(T));
    }
    return status::Good;
}

template <typename T>
StatusCode ImageChanges::add_each(const ImagePlace& place, std::span<const T> values)
{
    for (std::size_t i = 0; i < values.size() && !is_too_much(); ++i) {
        if (const StatusCode added = add_element(place, i, values[i]); !added.is_good()) {
            return added;
        }
    }
    return status::Good;
}

template <typename T>
StatusCode ImageChanges::add_elements(const ImagePlace& place, const NumericRange& range,
                                      const Variant& value)
{
    busbar::detail::Box box;
    if (const StatusCode found = find_box(place, range, box); !found.is_good()) {
        return found;
    }
    const std::span<const T> values = elements_of<T>(value);
    if (!fits(box, value, values.size())) {
        return status::Bad_IndexRangeDataMismatch;
    }
    if constexpr (is_image_text<T>) {
        if (std::ranges::any_of(values, [&](const T& t) { return !text_has_room(place, t); })) {
            return status::Bad_OutOfRange;
        }
    } else if constexpr (!std::same_as<T, ExtensionObject>) {
        if (!std::ranges::all_of(values, [&](T number) { return is_in_range(place, number); })) {
            return status::Bad_OutOfRange;
        }
    }
    std::size_t next = 0;
    StatusCode status;
    busbar::detail::walk(box, [&](std::size_t index) {
        status = add_element(place, index, values[next++]);
        return status.is_good() && !is_too_much();
    });
    return status;
}

StatusCode ImageChanges::add_whole(const ImagePlace& place, const Variant& value)
{
    if (const StatusCode checked = check_value(place, value); !checked.is_good()) {
        return checked;
    }
    if (place.is_structure()) {
        return add_each(place, elements_of<ExtensionObject>(value));
    }
    if (!place.is_text()) {
        const auto from = number_bytes(value);
        std::memcpy(grow(0, from.size()), from.data(), from.size());
        return status::Good;
    }
    return visit_image_type(
        place.type,
        [&](auto tag) -> StatusCode {
            using T = typename decltype(tag)::type;
            if constexpr (is_image_text<T>) {
                return add_each(place, elements_of<T>(value));
            }
            return status::Good;
        },
        [] { return StatusCode{status::Bad_TypeMismatch}; });
}

StatusCode ImageChanges::add_range(const ImagePlace& place, const NumericRange& range,
                                   const Variant& value)
{
    if (value.type() != place.type) {
        return status::Bad_TypeMismatch;
    }
    if (place.is_structure()) {
        return add_elements<ExtensionObject>(place, range, value);
    }
    return visit_image_type(
        place.type,
        [&](auto tag) { return add_elements<typename decltype(tag)::type>(place, range, value); },
        [] { return StatusCode{status::Bad_TypeMismatch}; });
}

std::byte* ImageChanges::grow(std::size_t to, std::size_t size)
{
    const std::size_t from = bytes_.size();
    bytes_.resize(from + size);
    Change* const before = changes_.size() > first_of_item_ ? &changes_.back() : nullptr;
    if (before != nullptr && before->to + before->size == to) {
        before->size += static_cast<std::uint32_t>(size);
    } else {
        changes_.push_back({static_cast<std::uint32_t>(to), static_cast<std::uint32_t>(from),
                            static_cast<std::uint32_t>(size)});
    }
    return bytes_.data() + from;
}

void ImageChanges::copy(const Item& item) const
{
    std::byte* const variable = variables_->bytes_of(item.handle);
    for (std::uint32_t i = item.first; i < item.first + item.count; ++i) {
        const Change& change = changes_[i];
        std::memcpy(variable + change.to, bytes_.data() + change.from, change.size);
    }
}

void ImageChanges::keep(ImageWriteLog& log, const ProcessImage& image)
{
    const auto is_kept = [&](const Item& item) {
        return item.result.is_good() && log.keeps(image, item.handle);
    };
    std::vector<ImageWrite> writes;
    StatusCode kept = status::Bad_OutOfMemory;
    busbar::detail::attempt([&] {
        for (const Item& item : items_) {
            for (std::uint32_t i = item.first; is_kept(item) && i < item.first + item.count; ++i) {
                const Change& change = changes_[i];
                writes.push_back(
                    {item.handle, change.to, std::span{bytes_}.subspan(change.from, change.size)});
            }
        }
        kept = writes.empty() ? StatusCode{} : log.keep(image, writes);
    });
    if (!kept.is_good()) {
        for (Item& item : items_) {
            item.result = is_kept(item) ? kept : item.result;
        }
    }
}

void ImageChanges::complete()
{
    const auto results = batch_.results();
    if (!results.empty()) {
        for (const Item& item : items_) {
            results[item.index] = item.result;
        }
    }
    batch_.complete();
}

} // namespace busbar::server::detail
