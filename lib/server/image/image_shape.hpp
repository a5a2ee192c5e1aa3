#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server::detail {

/// The bytes of one value in an image.
struct ImageExtent {
    std::uint64_t size{0};
    std::uint32_t alignment{1};
};

/// Returns the extent of a number, or of a text of at most `capacity` bytes; size 0 for a type that
/// an image does not have or that needs an ImageStructure.
[[nodiscard]] BUSBAR_API ImageExtent extent_of(BuiltInType type, std::uint64_t capacity);

/// Returns a variable's place without its offset. `room` is the maximum number of its bytes. For
/// errors see ImageLayout::add.
[[nodiscard]] Result<ImagePlace> shape_of(const ImageVariable& variable, std::size_t room);

/// Returns the alignment of the place, within a structure or on its own.
[[nodiscard]] std::uint32_t alignment_of(const ImagePlace& place);

[[nodiscard]] constexpr std::size_t round_up(std::size_t offset, std::size_t unit)
{
    return (offset + unit - 1) / unit * unit;
}

} // namespace busbar::server::detail
