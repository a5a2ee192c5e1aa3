#pragma once

#include <memory>

#include <busbar/core/numeric_range.hpp>
#include <busbar/types/filter.hpp>

#include "event_fields.hpp"
#include "server/rights/node_rights.hpp"

namespace busbar::server::detail {

/// For whom an event is looked at.
struct EventReader {
    const model::AddressSpace& space;
    /// Null: may read every field.
    const NodeRights* rights{nullptr};
};

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

    /// Looks up whose RolePermissions the field takes, now and whenever EventFields::version is
    /// another.
    void take_guards(EventFields& fields);
    [[nodiscard]] bool has_guards() const { return !guards_.empty(); }

    /// The value, which may lie in `storage`: null if the event has no such field, a StatusCode if
    /// it has none now, as when a range has no element: Bad_UserAccessDenied if it is not for the
    /// user (Part 4, 7.22.3).
    [[nodiscard]] const Variant& value(const RaisedEvent& event, const EventReader& reader,
                                       Variant& storage) const;
    /// As value(), with null in place of a StatusCode that is not the field's value: nobody finds
    /// out by a whereClause what he may not read.
    [[nodiscard]] const Variant& value_in_filter(const RaisedEvent& event,
                                                 const EventReader& reader, Variant& storage) const;

private:
    FieldOperand() = default;

    [[nodiscard]] Result<void> take_path(const SimpleAttributeOperand& operand, EventFields& fields,
                                         model::NodeIndex type, FieldDeclaration& declaration);
    [[nodiscard]] Result<void> take_range(const SimpleAttributeOperand& operand,
                                          const FieldDeclaration& declaration);
    [[nodiscard]] const Variant* find(const RaisedEvent& event) const;
    [[nodiscard]] bool is_denied(const RaisedEvent& event, const EventReader& reader) const;

    /// Of the clause.
    model::NodeIndex type_{model::no_node};
    /// It is BaseEventType, which stands for every type: which one an event has does not matter.
    bool is_any_type_{false};
    std::optional<BaseField> base_;
    /// Empty: the event's node itself.
    std::vector<QualifiedName> path_;
    std::unique_ptr<const NumericRange> range_;
    bool is_status_{false};
    std::vector<FieldGuard> guards_;
};

} // namespace busbar::server::detail
