#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/result.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server::detail {

/// A variable's place but for its offset. `room` is how many bytes it may take. For errors see
/// ImageLayout::add.
[[nodiscard]] Result<ImagePlace> shape_of(const ImageVariable& variable, std::size_t room);

/// At a multiple of how much it lies, within a structure or on its own.
[[nodiscard]] std::uint32_t alignment_of(const ImagePlace& place);

[[nodiscard]] constexpr std::size_t round_up(std::size_t offset, std::size_t unit)
{
    return (offset + unit - 1) / unit * unit;
}

} // namespace busbar::server::detail
