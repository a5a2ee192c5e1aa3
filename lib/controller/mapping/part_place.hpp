#pragma once

#include <string>

#include <busbar/controller/mapping.hpp>

namespace busbar::controller::detail {

/// Where a walk through parts is; lives on the stack, one within another.
struct PartPlace {
    const PartPlace* above{nullptr};
    const MappedPart* part{nullptr};
};

/// "[2].Speed"; empty for the whole value.
[[nodiscard]] inline std::string path_of(const PartPlace& place)
{
    const std::string above = place.above == nullptr ? std::string{} : path_of(*place.above);
    return place.part == nullptr ? above : part_path(above, *place.part);
}

} // namespace busbar::controller::detail
