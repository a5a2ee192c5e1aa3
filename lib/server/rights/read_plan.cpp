#include "read_plan.hpp"

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>

#include "live_values.hpp"
#include "method_lookup.hpp"
#include "model/record.hpp"
#include "node_rights.hpp"

namespace busbar::server::detail {

namespace {

constexpr auto value_attribute = static_cast<std::uint32_t>(AttributeId::Value);

/// Part 4, 7.29: a null DataEncoding is the default one. Bad_DataEncodingInvalid if none may be
/// requested: for anything except the Value of a Variable, or for a value that is not a Structure.
/// Bad_DataEncodingUnsupported for one that a structure does not have: the only one of this
/// protocol is "Default Binary".
StatusCode check_data_encoding(const ReadContext& context, const ReadTarget& id,
                               const model::VariableAttributes* variable)
{
    if (id.has_default_encoding()) {
        return status::Good;
    }
    if (variable == nullptr || !context.space.is_subtype_of(variable->data_type, id::Structure)) {
        return status::Bad_DataEncodingInvalid;
    }
    const bool is_binary =
        id.data_encoding->namespace_index == 0 && id.data_encoding->name.view() == "Default Binary";
    return is_binary ? status::Good : status::Bad_DataEncodingUnsupported;
}

StatusCode check_access(const ReadContext& context, model::NodeIndex node,
                        const model::VariableAttributes& variable)
{
    if (const StatusCode weak = context.rights.check_channel(node); weak.is_bad()) {
        return weak;
    }
    if (!has_access(variable.access_level, AccessLevelType::CurrentRead)) {
        return status::Bad_NotReadable;
    }
    const std::uint8_t level = context.rights.access_level(node, variable);
    return has_access(level, AccessLevelType::CurrentRead) ? status::Good
                                                           : status::Bad_UserAccessDenied;
}

/// RolePermissions are for administrators and users with the permission to read them (Part 3, 5.2.9
/// and 8.55).
StatusCode check_role_permissions(const ReadContext& context, model::NodeIndex node)
{
    if (const StatusCode weak = context.rights.check_channel(node); weak.is_bad()) {
        return weak;
    }
    const bool is_admin = is_administrator(context.space, context.rights.user);
    const model::NodeAccess* const access = context.space.node_access(node);
    const bool has_some = access != nullptr && !access->role_permissions.is_null();
    return is_admin || !has_some ||
                   context.rights.is_permitted(PermissionType::ReadRolePermissions, node)
               ? status::Good
               : status::Bad_UserAccessDenied;
}

/// Returns the RolePermissions of the session's roles (Part 3, 5.2.10).
Result<Variant> own_role_permissions(const ReadContext& context, model::NodeIndex node)
{
    const model::NodeAccess* const access = context.space.node_access(node);
    if (access == nullptr || access->role_permissions.is_null()) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    Array<ExtensionObject> permissions;
    permissions.clear(); // not null
    for (const RolePermissionType& each :
         user_role_permissions(context.space, context.rights.user, access->role_permissions)) {
        permissions.push_back(ExtensionObject::from(each));
    }
    return Variant{std::move(permissions)};
}

/// Returns a text in the best locale for the reader (Part 4, 5.4).
void translate(const ReadContext& context, model::NodeIndex node, AttributeId attribute,
               Variant& value)
{
    if (context.locales.empty() || value.type() != BuiltInType::LocalizedText) {
        return;
    }
    if (auto* const text = value.get_if<LocalizedText>()) {
        context.space.translate(node, attribute, context.locales, *text);
    }
}

/// Part 3, 5.6.2 and 5.5.1: these say that history can be read or updated, or is being collected. A
/// server without history says so of no node, whatever a file says.
void hide_history(AttributeId attribute_id, Variant& value)
{
    constexpr unsigned history = static_cast<unsigned>(AccessLevelType::HistoryRead) |
                                 static_cast<unsigned>(AccessLevelType::HistoryWrite);
    if (attribute_id == AttributeId::Historizing) {
        value = Variant{false};
    } else if (const auto* const level = value.get_if<std::uint8_t>();
               level != nullptr) { // AccessLevel, UserAccessLevel, EventNotifier
        value = Variant{static_cast<std::uint8_t>(*level & ~history)};
    } else if (const auto* const more = value.get_if<std::uint32_t>();
               more != nullptr && attribute_id == AttributeId::AccessLevelEx) {
        value = Variant{*more & ~std::uint32_t{history}};
    }
}

/// Returns any attribute except a Variable's Value.
Result<Variant> attribute(const ReadContext& context, const ReadTarget& id, model::NodeIndex node)
{
    const model::AddressSpace& space = context.space;
    const auto attribute_id = static_cast<AttributeId>(id.attribute_id);
    if (const StatusCode weak = context.rights.check_browse_channel(node); weak.is_bad()) {
        return fail(weak);
    }
    // First: no channel is strong enough for an attribute that no node of the class has.
    if (!model::AddressSpace::has_attribute(space.node_class(node), attribute_id)) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    if (id.attribute_id == value_attribute) {
        if (const StatusCode weak = context.rights.check_channel(node); weak.is_bad()) {
            return fail(weak);
        }
    }
    if (attribute_id == AttributeId::Value) {
        Variant value = space.value(node);
        if (space.node_class(node) != NodeClass::VariableType || value.is_null()) {
            return fail(status::Bad_AttributeIdInvalid);
        }
        return value;
    }
    if (attribute_id == AttributeId::UserAccessLevel &&
        space.node_class(node) == NodeClass::Variable) {
        Variant level{context.rights.access_level(node, space.variable(node))};
        hide_history(attribute_id, level);
        return level;
    }
    if (space.node_class(node) == NodeClass::Method && attribute_id == AttributeId::Executable) {
        return Variant{is_executable(space, node)};
    }
    if (space.node_class(node) == NodeClass::Method &&
        attribute_id == AttributeId::UserExecutable) {
        return Variant{is_user_executable(space, context.rights, node)};
    }
    if (attribute_id == AttributeId::WriteMask) {
        return Variant{write_mask(space, node)};
    }
    if (attribute_id == AttributeId::UserWriteMask) {
        return Variant{user_write_mask(context.rights, node)};
    }
    if (attribute_id == AttributeId::UserRolePermissions) {
        return own_role_permissions(context, node);
    }
    if (attribute_id == AttributeId::RolePermissions) {
        if (const StatusCode denied = check_role_permissions(context, node); denied.is_bad()) {
            return fail(denied);
        }
    }
    auto value = space.attribute(node, attribute_id);
    if (value) {
        translate(context, node, attribute_id, *value);
        hide_history(attribute_id, *value);
    }
    return value;
}

/// Returns the value of a Variable without data source.
DataValue kept_value(const ReadContext& context, const ReadTarget& id, model::NodeIndex node,
                     std::uint32_t source)
{
    if (id.node_id.namespace_index() == 0 || source == live_values_source) {
        if (auto live = context.live_value(id.node_id)) {
            return std::move(*live);
        }
    }
    DataValue value = context.space.data_value(node);
    if (value.source_timestamp.is_null() && value.source_timestamp != model::detail::no_time) {
        value.source_timestamp = context.start_time;
    }
    translate(context, node, AttributeId::Value, value.value);
    return value;
}

ReadPlan answered(DataValue value)
{
    ReadPlan plan;
    plan.answer = std::move(value);
    return plan;
}

ReadPlan plan_value(const ReadContext& context, const ReadTarget& id, model::NodeIndex node)
{
    const model::VariableAttributes variable = context.space.variable(node);
    StatusCode refusal = check_access(context, node, variable);
    if (refusal.is_good()) {
        refusal = check_data_encoding(context, id, &variable);
    }
    if (refusal.is_bad()) {
        return answered(refusal);
    }
    if (variable.source == model::no_source || variable.source == live_values_source) {
        return answered(kept_value(context, id, node, variable.source));
    }
    const auto* source = context.sources.find(variable.source);
    if (source == nullptr) {
        return answered(StatusCode{status::Bad_NoCommunication});
    }
    return {source->get(), variable.source, variable.handle, {}};
}

} // namespace

ReadPlan plan_read(const ReadContext& context, const ReadTarget& id)
{
    return plan_read(context, id, context.space.find(id.node_id));
}

ReadPlan plan_read(const ReadContext& context, const ReadTarget& id, model::NodeIndex node)
{
    if (node == model::no_node || !context.rights.may_see(node)) {
        return answered(why_not_found(id.node_id));
    }
    if (id.attribute_id == value_attribute &&
        context.space.node_class(node) == NodeClass::Variable) {
        return plan_value(context, id, node);
    }
    Result<Variant> value = attribute(context, id, node);
    const StatusCode refusal = value ? check_data_encoding(context, id, nullptr) : value.error();
    return answered(refusal.is_bad() ? DataValue{refusal} : DataValue{std::move(*value)});
}

} // namespace busbar::server::detail
