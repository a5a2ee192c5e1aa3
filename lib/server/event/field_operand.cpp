#include "field_operand.hpp"

#include <algorithm>

namespace busbar::server::detail {

namespace {

const Variant no_value;

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
    // BaseEventType stands for every type (Part 4, 7.22.3).
    const bool is_any = operand.type_definition_id.is(id::BaseEventType);
    result.type_ = is_any ? model::no_node : *type;
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

const Variant& FieldOperand::value(const RaisedEvent& event, const model::AddressSpace& space,
                                   Variant& storage) const
{
    if (type_ != model::no_node && !space.is_subtype_of(event.type(), type_)) {
        return no_value;
    }
    const Variant* const whole = find(event);
    if (whole == nullptr || range_ == nullptr || whole->type() == BuiltInType::StatusCode) {
        return whole == nullptr ? no_value : *whole;
    }
    auto part = read_range(*whole, *range_);
    storage = part ? *std::move(part) : Variant{part.error()};
    return storage;
}

const Variant& FieldOperand::value_in_filter(const RaisedEvent& event,
                                             const model::AddressSpace& space,
                                             Variant& storage) const
{
    const Variant& found = value(event, space, storage);
    return found.type() == BuiltInType::StatusCode && !is_status_ ? no_value : found;
}

} // namespace busbar::server::detail
