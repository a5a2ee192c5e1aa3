#pragma once

#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

#include "node_rights.hpp"

namespace busbar::server::detail {

/// Returns the Method that is executed when `method` is called on `object` (Part 4, 5.12.2.2): a
/// component of the Object or ObjectType, or of its type or one above that; an Object's own Method
/// of this name has precedence over the type's.
///
/// Bad_NodeIdInvalid, Bad_NodeIdUnknown or Bad_MethodInvalid (Part 4, 5.12.2.4);
/// Bad_TooManyOperations once `visits` reaches zero, which is decremented for each reference it
/// looks at.
[[nodiscard]] Result<model::NodeIndex> find_method(const model::AddressSpace& space,
                                                   const NodeRights& rights, const NodeId& object,
                                                   const NodeId& method, std::size_t& visits);

/// Returns the Executable attribute of a Method (Part 3, 5.7.1): false also if no source carries it
/// out.
[[nodiscard]] bool is_executable(const model::AddressSpace& space, model::NodeIndex method);
/// Returns its UserExecutable attribute.
[[nodiscard]] bool is_user_executable(const model::AddressSpace& space, const NodeRights& rights,
                                      model::NodeIndex method);

} // namespace busbar::server::detail
