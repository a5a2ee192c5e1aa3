#pragma once

#include <busbar/model/address_space.hpp>
#include <busbar/server/namespace_metadata.hpp>

namespace busbar::server::detail {

/// Returns the object below Server.Namespaces that describes the namespace, which is added with
/// defaults if there is none (Part 5, 6.3.13 and 6.3.14). New nodes have string identifiers in
/// `own_namespace`. Bad_NotSupported if namespace 0 is too small for it, Bad_NotFound if there is
/// no namespace with this index.
Result<model::NodeIndex> find_or_add_namespace(model::AddressSpace& space,
                                               std::uint16_t own_namespace, std::uint16_t index);
/// Gives the object's properties their values.
void set_metadata(model::AddressSpace& space, model::NodeIndex object,
                  const NamespaceMetadata& metadata);
/// Sets only version and publication date.
void set_version(model::AddressSpace& space, model::NodeIndex object,
                 const NamespaceMetadata& metadata);
/// Shows the DefaultRolePermissions and DefaultAccessRestrictions of the namespace in the object;
/// the properties exist only if the namespace has some. The permissions are for administrators, as
/// the attribute RolePermissions is.
void show_defaults(model::AddressSpace& space, model::NodeIndex object, std::uint16_t index);

} // namespace busbar::server::detail
