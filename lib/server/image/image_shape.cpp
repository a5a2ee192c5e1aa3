#include "image_shape.hpp"

#include <algorithm>
#include <span>

#include <busbar/core/numeric_range.hpp>
#include <busbar/server/image_structure.hpp>

#include "image_types.hpp"

namespace busbar::server::detail {

namespace {

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

ImageExtent extent_of(BuiltInType type, std::uint64_t capacity)
{
    return visit_image_type(
        type,
        [&](auto tag) -> ImageExtent {
            using T = typename decltype(tag)::type;
            constexpr std::uint32_t unit = alignof(ImageText);
            if constexpr (is_image_text<T>) {
                return {(sizeof(ImageText) + capacity + unit - 1) / unit * unit, unit};
            } else {
                return {sizeof(T), std::is_same_v<T, Guid> ? unit : std::uint32_t{sizeof(T)}};
            }
        },
        [] { return ImageExtent{}; });
}

Result<ImagePlace> shape_of(const ImageVariable& variable, std::size_t room)
{
    std::uint64_t stride = extent_of(variable.type, variable.capacity).size;
    if (variable.type == BuiltInType::ExtensionObject && variable.structure != nullptr) {
        stride = variable.structure->size();
    }
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
    return place.is_structure() ? place.structure->alignment()
                                : extent_of(place.type, place.capacity).alignment;
}

} // namespace busbar::server::detail
