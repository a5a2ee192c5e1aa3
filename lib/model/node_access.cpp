#include <busbar/model/address_space.hpp>

#include <busbar/binary/codec.hpp>

#include "namespace_map.hpp"
#include "tables.hpp"

namespace busbar::model {

namespace detail {

NodeAccess node_access(const StaticNodes& nodes, const StaticAccess& from,
                       std::span<const std::uint16_t> map)
{
    NodeAccess access;
    access.write_mask = from.write_mask;
    access.more_access_levels = from.more_access_levels;
    if (from.has_restrictions) {
        access.restrictions = from.restrictions;
    }
    if (from.role_permissions.size == 0) {
        return access;
    }
    const std::string_view bytes =
        nodes.values.substr(from.role_permissions.offset, from.role_permissions.size);
    binary::Reader reader{std::as_bytes(std::span{bytes.data(), bytes.size()})};
    Variant value;
    decode(reader, value);
    map_namespaces(value, map);
    access.role_permissions.clear(); // not null
    if (const auto* const permissions = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& each : *permissions) {
            auto permission = binary::from_bytes<RolePermissionType>(each.binary().span());
            access.role_permissions.push_back(permission ? *std::move(permission)
                                                         : RolePermissionType{});
        }
    }
    return access;
}

} // namespace detail

const NodeAccess* SpaceReader::node_access(NodeIndex node) const
{
    return tables_->access.find(node);
}

std::uint16_t SpaceReader::access_restrictions(NodeIndex node) const
{
    const NodeAccess* const own = node_access(node);
    if (own != nullptr && own->restrictions) {
        return *own->restrictions;
    }
    return tables_->namespace_restrictions.empty()
               ? std::uint16_t{0}
               : namespace_restrictions(tables_->id_of(node).namespace_index());
}

std::uint16_t SpaceReader::namespace_restrictions(std::uint16_t namespace_index) const
{
    const auto& by_namespace = tables_->namespace_restrictions;
    return namespace_index < by_namespace.size() ? by_namespace[namespace_index] : std::uint16_t{0};
}

const Array<RolePermissionType>* SpaceReader::role_permissions(NodeIndex node) const
{
    const NodeAccess* const own = node_access(node);
    if (own != nullptr && !own->role_permissions.is_null()) {
        return &own->role_permissions;
    }
    const auto& by_namespace = tables_->namespace_permissions;
    if (by_namespace.empty()) {
        return nullptr;
    }
    const std::uint16_t index = tables_->id_of(node).namespace_index();
    return index < by_namespace.size() && !by_namespace[index].is_null() ? &by_namespace[index]
                                                                         : nullptr;
}

Array<RolePermissionType> SpaceReader::namespace_permissions(std::uint16_t namespace_index) const
{
    const auto& by_namespace = tables_->namespace_permissions;
    return namespace_index < by_namespace.size() ? by_namespace[namespace_index]
                                                 : Array<RolePermissionType>{};
}

void AddressSpace::set_node_access(NodeIndex node, NodeAccess access)
{
    ++tables_->access_changes;
    if (access == NodeAccess{} && access.role_permissions.is_null()) {
        tables_->access.erase(node);
    } else {
        tables_->access.set(node, std::move(access));
    }
    tables_->watches.tell(node, NodeAspect::Binding);
}

void AddressSpace::set_namespace_restrictions(std::uint16_t index, std::uint16_t restrictions)
{
    ++tables_->access_changes;
    auto& by_namespace = tables_->namespace_restrictions;
    if (by_namespace.size() <= index) {
        by_namespace.resize(index + std::size_t{1});
    }
    by_namespace[index] = restrictions;
    tables_->watches.tell_bindings(
        [&](NodeIndex node) { return tables_->id_of(node).namespace_index() == index; });
}

void AddressSpace::set_namespace_permissions(std::uint16_t index,
                                             Array<RolePermissionType> permissions)
{
    ++tables_->access_changes;
    auto& by_namespace = tables_->namespace_permissions;
    if (by_namespace.size() <= index) {
        by_namespace.resize(index + std::size_t{1});
    }
    by_namespace[index] = std::move(permissions);
    tables_->watches.tell_bindings(
        [&](NodeIndex node) { return tables_->id_of(node).namespace_index() == index; });
}

Result<Variant> SpaceReader::access_attribute(NodeIndex node, AttributeId id) const
{
    static const NodeAccess none;
    const NodeAccess* const own = node_access(node);
    const NodeAccess& access = own == nullptr ? none : *own;
    switch (id) {
    case AttributeId::WriteMask:
        return Variant{access.write_mask};
    case AttributeId::AccessLevelEx:
        return Variant{variable(node).access_level | access.more_access_levels};
    case AttributeId::AccessRestrictions:
        return access.restrictions ? Result<Variant>{Variant{*access.restrictions}}
                                   : fail(status::Bad_AttributeIdInvalid);
    case AttributeId::RolePermissions:
        break;
    default:
        return fail(status::Bad_AttributeIdInvalid);
    }
    if (access.role_permissions.is_null()) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    Array<ExtensionObject> permissions;
    permissions.reserve(access.role_permissions.size());
    for (const RolePermissionType& permission : access.role_permissions) {
        permissions.push_back(ExtensionObject::from(permission));
    }
    return Variant{std::move(permissions)};
}

} // namespace busbar::model
