#include "field_operand.hpp"

#include <algorithm>

namespace busbar::server::detail {

namespace {

const Variant no_value;
const Variant access_denied{StatusCode{status::Bad_UserAccessDenied}};

Result<model::NodeIndex> find_event_type(const model::AddressSpace& space, const NodeId& id)
{
    const model::NodeIndex type = space.find(id);
    if (!space.is_subtype_of(type, id::BaseEventType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return type;
}

} // namespace

Result<FieldOperand> FieldOperand::create(const SimpleAttributeOperand& operand,
                                          EventFields& fields, std::size_t max_path_elements)
{
    const auto type = find_event_type(fields.space(), operand.type_definition_id);
    if (!type) {
        return fail(type.error());
    }
    if (std::any_of(operand.browse_path.begin(), operand.browse_path.end(),
                    [](const QualifiedName& name) { return name.name.empty(); })) {
        return fail(status::Bad_BrowseNameInvalid);
    }
    if (operand.browse_path.size() > max_path_elements) {
        return fail(status::Bad_NodeIdUnknown);
    }
    FieldOperand result;
    // BaseEventType means every type (Part 4, 7.22.3).
    result.is_any_type_ = operand.type_definition_id.is(id::BaseEventType);
    result.type_ = *type;
    FieldDeclaration declaration;
    if (const auto taken = result.take_path(operand, fields, *type, declaration); !taken) {
        return fail(taken.error());
    }
    if (const auto taken = result.take_range(operand, declaration); !taken) {
        return fail(taken.error());
    }
    return result;
}

Result<void> FieldOperand::take_path(const SimpleAttributeOperand& operand, EventFields& fields,
                                     model::NodeIndex type, FieldDeclaration& declaration)
{
    path_.assign(operand.browse_path.begin(), operand.browse_path.end());
    base_ = find_base_field(path_);
    declaration.is_object = path_.empty();
    if (!path_.empty()) {
        const auto found = fields.find(type, path_);
        if (!found) {
            return fail(status::Bad_NodeIdUnknown);
        }
        declaration = *found;
    }
    is_status_ = declaration.is_status;
    // Part 4, 7.22.3: the Value of a Variable and the NodeId of an Object.
    const AttributeId attribute = declaration.is_object ? AttributeId::NodeId : AttributeId::Value;
    if (AttributeId{operand.attribute_id} != attribute) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    return {};
}

Result<void> FieldOperand::take_range(const SimpleAttributeOperand& operand,
                                      const FieldDeclaration& declaration)
{
    if (operand.index_range.empty()) {
        return {};
    }
    const auto range = NumericRange::parse(operand.index_range.view());
    if (!range) {
        return fail(status::Bad_IndexRangeInvalid);
    }
    if (!declaration.is_divisible) {
        return fail(status::Bad_TypeMismatch);
    }
    range_ = std::make_unique<const NumericRange>(*range);
    return {};
}

const Variant* FieldOperand::find(const RaisedEvent& event) const
{
    if (base_) {
        return &event[*base_];
    }
    return path_.empty() ? &event.instance() : event.find(path_);
}

void FieldOperand::take_guards(EventFields& fields)
{
    guards_.clear();
    if (!path_.empty()) { // the NodeId of the event's own node has no declaration
        fields.find_guards(type_, path_, guards_);
    }
}

/// Checks each declaration that the event's type has or inherits.
bool FieldOperand::is_denied(const RaisedEvent& event, const EventReader& reader) const
{
    return reader.rights != nullptr &&
           std::any_of(guards_.begin(), guards_.end(), [&](const FieldGuard& guard) {
               const model::AddressSpace& space = reader.space;
               const model::NodeIndex node = space.resolve(guard.node);
               if (node == model::no_node || !space.is_subtype_of(event.type(), guard.owner)) {
                   return false;
               }
               const bool is_value = space.node_class(node) == NodeClass::Variable;
               return !reader.rights->is_permitted(
                   is_value ? PermissionType::Read : PermissionType::Browse, node);
           });
}

const Variant& FieldOperand::value(const RaisedEvent& event, const EventReader& reader,
                                   Variant& storage) const
{
    if (!is_any_type_ && !reader.space.is_subtype_of(event.type(), type_)) {
        return no_value;
    }
    if (!guards_.empty() && is_denied(event, reader)) {
        return access_denied;
    }
    const Variant* const whole = find(event);
    if (whole == nullptr || range_ == nullptr || whole->type() == BuiltInType::StatusCode) {
        return whole == nullptr ? no_value : *whole;
    }
    auto part = read_range(*whole, *range_);
    storage = part ? *std::move(part) : Variant{part.error()};
    return storage;
}

const Variant& FieldOperand::value_in_filter(const RaisedEvent& event, const EventReader& reader,
                                             Variant& storage) const
{
    const Variant& found = value(event, reader, storage);
    const bool is_reason = found.type() == BuiltInType::StatusCode && !is_status_;
    return is_reason || &found == &access_denied ? no_value : found;
}

} // namespace busbar::server::detail
