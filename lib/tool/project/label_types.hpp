#pragma once

#include <string>

#include <busbar/controller/mappable_parts.hpp>

#include "commands.hpp"

namespace busbar::tool::project {

/// Lists of what labels are declared as ("INT; UINT, WORD"), by how they suit a part of a node
/// (seed 001, 8.2).
struct LabelTypes {
    std::string same;
    /// Where the value is in the range of both.
    std::string checked;
};
[[nodiscard]] LabelTypes label_types_for(const controller::MappablePart& part);

/// What labels are declared as, and the DataTypes of nodes that can be mapped to them.
Exit list_label_types(Context& context, const ProjectArguments& arguments);

} // namespace busbar::tool::project
