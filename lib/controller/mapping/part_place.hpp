#pragma once

#include <string>

#include <busbar/controller/mapping.hpp>

namespace busbar::controller::detail {

/// The current place of a walk through parts. Places are linked and live on the stack.
struct PartPlace {
    const PartPlace* above{nullptr};
    const MappedPart* part{nullptr};
};

/// Writes the path of a place: "[2].Speed", empty for the whole value.
[[nodiscard]] inline std::string path_of(const PartPlace& place)
{
    const std::string above = place.above == nullptr ? std::string{} : path_of(*place.above);
    return place.part == nullptr ? above : part_path(above, *place.part);
}

} // namespace busbar::controller::detail
