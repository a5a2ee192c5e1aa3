#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/result.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server::detail {

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
