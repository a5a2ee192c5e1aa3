#include "image_shape.hpp"

#include <algorithm>
#include <span>

#include <busbar/core/numeric_range.hpp>
#include <busbar/server/image_structure.hpp>

#include "image_types.hpp"

namespace busbar::server::detail {

namespace {

/// Returns the bytes of one element, 0 for a type that an image cannot have; for a text they may
/// exceed the possible size.
std::uint64_t stride_of(const ImageVariable& variable)
{
    if (variable.type == BuiltInType::ExtensionObject) {
        return variable.structure != nullptr ? variable.structure->size() : 0;
    }
    return visit_image_type(
        variable.type,
        [&](auto tag) -> std::uint64_t {
            using T = typename decltype(tag)::type;
            if constexpr (is_image_text<T>) {
                constexpr std::uint64_t unit = alignof(ImageText);
                const std::uint64_t bytes = std::uint64_t{sizeof(ImageText)} + variable.capacity;
                return (bytes + unit - 1) / unit * unit;
            } else {
                return sizeof(T);
            }
        },
        [] { return std::uint64_t{0}; });
}

/// Returns the number of elements, 0 if there are more than `most`.
std::uint64_t count_of(std::span<const std::uint32_t> dimensions, std::uint64_t most)
{
    std::uint64_t count = 1;
    for (const std::uint32_t dimension : dimensions) {
        count *= dimension;
        if (count > most) {
            return 0;
        }
    }
    return count <= most ? count : 0;
}

} // namespace

Result<ImagePlace> shape_of(const ImageVariable& variable, std::size_t room)
{
    const std::uint64_t stride = stride_of(variable);
    if (stride == 0) {
        return fail(status::Bad_DataTypeIdUnknown);
    }
    if (variable.dimensions.size() > NumericRange::max_dimensions ||
        std::ranges::find(variable.dimensions, 0U) != variable.dimensions.end()) {
        return fail(status::Bad_OutOfRange);
    }
    const std::uint64_t count = count_of(variable.dimensions, room / stride);
    if (count == 0) {
        return fail(status::Bad_OutOfMemory);
    }
    ImagePlace place;
    place.type = variable.type;
    place.is_read_only = variable.is_read_only;
    place.stride = static_cast<std::uint32_t>(stride);
    place.elements = static_cast<std::uint32_t>(count);
    place.dimensions = variable.dimensions;
    place.capacity = place.is_text() ? variable.capacity : 0;
    place.max_units = place.is_text() ? variable.max_units : 0;
    if (variable.type == BuiltInType::ExtensionObject) {
        place.structure = variable.structure;
    }
    place.range = variable.range;
    return place;
}

std::uint32_t alignment_of(const ImagePlace& place)
{
    if (place.is_structure()) {
        return place.structure->alignment();
    }
    constexpr std::uint32_t of_text = alignof(ImageText);
    return place.is_text() || place.type == BuiltInType::Guid ? of_text : place.stride;
}

} // namespace busbar::server::detail
