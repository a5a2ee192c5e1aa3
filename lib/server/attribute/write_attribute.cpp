#include "write_job.hpp"

#include <algorithm>
#include <cmath>

#include "server/rights/node_rights.hpp"

namespace busbar::server::detail {

namespace {

/// Returns the reason why the attribute is not in the WriteMask.
StatusCode why_not_in_mask(const model::AddressSpace& space, model::NodeIndex node,
                           AttributeId attribute)
{
    const bool is_there = attribute == AttributeId::Value
                              ? space.node_class(node) == NodeClass::VariableType
                              : space.attribute(node, attribute).has_value();
    if (!is_there) {
        return status::Bad_AttributeIdInvalid;
    }
    const model::NodeAccess* const access = space.node_access(node);
    const bool is_wanted =
        access != nullptr && (access->write_mask & write_mask_bit(attribute)) != 0;
    return is_wanted ? status::Bad_WriteNotSupported : status::Bad_NotWritable;
}

/// Attributes have neither status nor timestamp, and parts of them cannot be written.
StatusCode check_form(const WriteValue& value)
{
    if (!value.index_range.empty()) {
        const auto range = NumericRange::parse(value.index_range.view());
        return range ? StatusCode{status::Bad_WriteNotSupported} : range.error();
    }
    const DataValue& data = value.value;
    return data.status != status::Good || !data.source_timestamp.is_null() ||
                   !data.server_timestamp.is_null()
               ? status::Bad_WriteNotSupported
               : status::Good;
}

StatusCode write_text(const WriteContext& context, model::NodeIndex node, AttributeId attribute,
                      const Variant& value)
{
    const auto* const text = value.get_if<LocalizedText>();
    if (text == nullptr) {
        return status::Bad_TypeMismatch;
    }
    if (const StatusCode bad = check_locale(context, node, attribute, *text); bad.is_bad()) {
        return bad;
    }
    const auto set = context.space.set_text(node, attribute, DataValue{value});
    return set ? StatusCode{status::Good} : set.error();
}

/// Part 3, 5.6.2: -1 means unknown.
StatusCode write_minimum_sampling_interval(const WriteContext& context, model::NodeIndex node,
                                           const Variant& value)
{
    const auto* const interval = value.get_if<double>();
    if (interval == nullptr) {
        return status::Bad_TypeMismatch;
    }
    if (!std::isfinite(*interval) || (*interval < 0 && *interval != -1)) {
        return status::Bad_OutOfRange;
    }
    context.space.set_minimum_sampling_interval(node, *interval);
    return status::Good;
}

model::NodeAccess access_of(const model::AddressSpace& space, model::NodeIndex node)
{
    const model::NodeAccess* const access = space.node_access(node);
    return access != nullptr ? *access : model::NodeAccess{};
}

StatusCode write_role_permissions(const WriteContext& context, model::NodeIndex node,
                                  const Variant& value)
{
    const auto* const sent = value.array_if<ExtensionObject>();
    if (sent == nullptr || sent->is_null()) {
        return status::Bad_TypeMismatch;
    }
    constexpr std::uint32_t all_bits = 2 * static_cast<std::uint32_t>(PermissionType::AddNode) - 1;
    if (sent->size() > max_written_role_permissions) {
        return status::Bad_OutOfRange;
    }
    Array<RolePermissionType> permissions;
    permissions.clear(); // not null
    for (const ExtensionObject& each : *sent) {
        const auto* const permission = each.get_if<RolePermissionType>();
        if (permission == nullptr) {
            return status::Bad_TypeMismatch;
        }
        if (static_cast<std::uint32_t>(permission->permissions) > all_bits) {
            return status::Bad_OutOfRange;
        }
        permissions.push_back(*permission);
    }
    model::NodeAccess access = access_of(context.space, node);
    access.role_permissions = std::move(permissions);
    context.space.set_node_access(node, std::move(access));
    return status::Good;
}

StatusCode write_access_restrictions(const WriteContext& context, model::NodeIndex node,
                                     const Variant& value)
{
    constexpr unsigned all_restrictions = 15; // Part 3, 8.56
    const auto* const restrictions = value.get_if<std::uint16_t>();
    if (restrictions == nullptr) {
        return status::Bad_TypeMismatch;
    }
    if ((*restrictions & ~all_restrictions) != 0) {
        return status::Bad_OutOfRange;
    }
    model::NodeAccess access = access_of(context.space, node);
    access.restrictions = *restrictions;
    context.space.set_node_access(node, std::move(access));
    return status::Good;
}

} // namespace

StatusCode check_locale(const WriteContext& context, model::NodeIndex node, AttributeId attribute,
                        const LocalizedText& text)
{
    const auto is_same = [&](std::string_view locale) {
        return std::equal(locale.begin(), locale.end(), text.locale.view().begin(),
                          text.locale.view().end());
    };
    const auto of_models = context.space.further_locales();
    if (text.locale.empty() ||
        std::any_of(context.locales.begin(), context.locales.end(), is_same) ||
        std::any_of(of_models.begin(), of_models.end(), is_same)) {
        return status::Good;
    }
    const auto there = context.space.texts(node, attribute);
    return std::any_of(there.begin(), there.end(),
                       [&](const LocalizedText& each) { return is_same(each.locale.view()); })
               ? status::Good
               : status::Bad_LocaleNotSupported;
}

StatusCode write_attribute(const WriteContext& context, model::NodeIndex node,
                           const WriteValue& value)
{
    const auto attribute = static_cast<AttributeId>(value.attribute_id);
    // First: no channel is strong enough for an attribute that no node of the class has.
    if (!model::AddressSpace::has_attribute(context.space.node_class(node), attribute)) {
        return status::Bad_AttributeIdInvalid;
    }
    if (const StatusCode weak = context.rights.check_channel(node); weak.is_bad()) {
        return weak;
    }
    const std::uint32_t bit = write_mask_bit(attribute);
    if ((write_mask(context.space, node) & bit) == 0) {
        return why_not_in_mask(context.space, node, attribute);
    }
    if ((user_write_mask(context.rights, node) & bit) == 0) {
        return status::Bad_UserAccessDenied;
    }
    if (const StatusCode bad = check_form(value); bad.is_bad()) {
        return bad;
    }
    switch (attribute) {
    case AttributeId::MinimumSamplingInterval:
        return write_minimum_sampling_interval(context, node, value.value.value);
    case AttributeId::RolePermissions:
        return write_role_permissions(context, node, value.value.value);
    case AttributeId::AccessRestrictions:
        return write_access_restrictions(context, node, value.value.value);
    default:
        return write_text(context, node, attribute, value.value.value);
    }
}

} // namespace busbar::server::detail
