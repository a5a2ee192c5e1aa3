#pragma once

#include <busbar/model/address_space.hpp>
#include <busbar/server/namespace_metadata.hpp>

namespace busbar::server::detail {

/// The object below Server.Namespaces that describes the namespace, which is added with defaults if
/// there is none (Part 5, 6.3.13 and 6.3.14). New nodes have string identifiers in
/// `own_namespace`. Bad_NotSupported if namespace 0 is too small for it, Bad_NotFound if there is
/// no namespace of that index.
Result<model::NodeIndex> find_or_add_namespace(model::AddressSpace& space,
                                               std::uint16_t own_namespace, std::uint16_t index);
/// Gives the object's properties their values.
void set_metadata(model::AddressSpace& space, model::NodeIndex object,
                  const NamespaceMetadata& metadata);
/// Of it version and publication date alone.
void set_version(model::AddressSpace& space, model::NodeIndex object,
                 const NamespaceMetadata& metadata);
/// Has the object say the DefaultRolePermissions and DefaultAccessRestrictions that the namespace
/// has; neither is there before it has some. The permissions are for administrators, as the
/// attribute RolePermissions is.
void show_defaults(model::AddressSpace& space, model::NodeIndex object, std::uint16_t index);

} // namespace busbar::server::detail
