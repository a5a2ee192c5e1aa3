#pragma once

#include <memory>

#include <busbar/core/numeric_range.hpp>
#include <busbar/types/filter.hpp>

#include "event_fields.hpp"

namespace busbar::server::detail {

/// A SimpleAttributeOperand (Part 4, 7.7.4.5) that was checked once and then finds its field in
/// each event.
class FieldOperand {
public:
    /// What is true of every event that may ever come (Part 4, 7.22.3):
    /// Bad_TypeDefinitionInvalid, the type is no event type; Bad_BrowseNameInvalid, the path has a
    /// null name; Bad_NodeIdUnknown, no event has that path; Bad_AttributeIdInvalid, the server
    /// never returns that attribute of the node; Bad_IndexRangeInvalid; Bad_TypeMismatch, the
    /// field is never an array.
    [[nodiscard]] static Result<FieldOperand> create(const SimpleAttributeOperand& operand,
                                                     EventFields& fields,
                                                     std::size_t max_path_elements);

    /// The value, which may lie in `storage`: null if the event has no such field, a StatusCode if
    /// it has none now, as when a range has no element.
    [[nodiscard]] const Variant& value(const RaisedEvent& event, const model::AddressSpace& space,
                                       Variant& storage) const;
    /// As value(), with null in place of a StatusCode that is not the field's value.
    [[nodiscard]] const Variant& value_in_filter(const RaisedEvent& event,
                                                 const model::AddressSpace& space,
                                                 Variant& storage) const;

private:
    FieldOperand() = default;

    [[nodiscard]] Result<void> take_path(const SimpleAttributeOperand& operand, EventFields& fields,
                                         model::NodeIndex type, FieldDeclaration& declaration);
    [[nodiscard]] Result<void> take_range(const SimpleAttributeOperand& operand,
                                          const FieldDeclaration& declaration);
    [[nodiscard]] const Variant* find(const RaisedEvent& event) const;

    /// Only events of this type have the field; no_node: the type does not matter.
    model::NodeIndex type_{model::no_node};
    std::optional<BaseField> base_;
    /// Empty: the event's node itself.
    std::vector<QualifiedName> path_;
    std::unique_ptr<const NumericRange> range_;
    bool is_status_{false};
};

} // namespace busbar::server::detail
