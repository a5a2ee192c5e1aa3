#pragma once

#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// One end of a reference, existing or about to be added.
struct ReferenceEnd {
    NodeClass node_class{NodeClass::Unspecified};
    /// The type definition of an Object or Variable.
    model::NodeIndex type_definition{model::no_node};
};

[[nodiscard]] ReferenceEnd reference_end(const model::AddressSpace& space, model::NodeIndex node);

/// Returns Good, or Bad_ReferenceNotAllowed if a reference of `type` never connects such nodes
/// (Part 3, clause 7). Does not repeat the checks of AddressSpace.
[[nodiscard]] StatusCode check_ends(const model::AddressSpace& space, model::NodeIndex type,
                                    const ReferenceEnd& source, const ReferenceEnd& target);

} // namespace busbar::server::detail
