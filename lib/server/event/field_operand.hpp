#pragma once

#include <memory>

#include <busbar/core/numeric_range.hpp>
#include <busbar/types/filter.hpp>

#include "event_fields.hpp"
#include "server/rights/node_rights.hpp"

namespace busbar::server::detail {

/// The reader of an event.
struct EventReader {
    const model::AddressSpace& space;
    /// If null, every field is readable.
    const NodeRights* rights{nullptr};
};

/// A SimpleAttributeOperand (Part 4, 7.7.4.5) that is checked once and then finds its field in each
/// event.
class FieldOperand {
public:
    /// Checks everything that is the same for all events (Part 4, 7.22.3):
    /// Bad_TypeDefinitionInvalid, the type is not an event type; Bad_BrowseNameInvalid, the path
    /// has a null name; Bad_NodeIdUnknown, no event has this path; Bad_AttributeIdInvalid, the
    /// server never returns this attribute of the node; Bad_IndexRangeInvalid; Bad_TypeMismatch,
    /// the field is never an array.
    [[nodiscard]] static Result<FieldOperand> create(const SimpleAttributeOperand& operand,
                                                     EventFields& fields,
                                                     std::size_t max_path_elements);

    /// Looks up which RolePermissions restrict the field, now and whenever EventFields::version
    /// changes.
    void take_guards(EventFields& fields);
    [[nodiscard]] bool has_guards() const { return !guards_.empty(); }

    /// Returns the value, which may be in `storage`: null if the event has no such field, a
    /// StatusCode if it has none now, for example if a range has no element, and
    /// Bad_UserAccessDenied if the user may not read it (Part 4, 7.22.3).
    [[nodiscard]] const Variant& value(const RaisedEvent& event, const EventReader& reader,
                                       Variant& storage) const;
    /// Returns as value(), with null in place of a StatusCode that is not the field's value, so
    /// that no user can find out by a whereClause what he may not read.
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

    /// The type in the clause.
    model::NodeIndex type_{model::no_node};
    /// True for BaseEventType, which means every type: the event's type does not matter.
    bool is_any_type_{false};
    std::optional<BaseField> base_;
    /// Empty for the event's node itself.
    std::vector<QualifiedName> path_;
    std::unique_ptr<const NumericRange> range_;
    bool is_status_{false};
    std::vector<FieldGuard> guards_;
};

} // namespace busbar::server::detail
