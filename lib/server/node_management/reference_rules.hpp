#pragma once

#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// One end of a reference, be it there or about to be added.
struct ReferenceEnd {
    NodeClass node_class{NodeClass::Unspecified};
    /// Of an Object or Variable.
    model::NodeIndex type_definition{model::no_node};
};

[[nodiscard]] ReferenceEnd reference_end(const model::AddressSpace& space, model::NodeIndex node);

/// Good, or Bad_ReferenceNotAllowed if a reference of `type` never leads from such a node to such
/// a one (Part 3, clause 7). What an AddressSpace itself checks is not looked at.
[[nodiscard]] StatusCode check_ends(const model::AddressSpace& space, model::NodeIndex type,
                                    const ReferenceEnd& source, const ReferenceEnd& target);

} // namespace busbar::server::detail
