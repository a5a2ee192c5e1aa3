#pragma once

#include <busbar/server/event_limits.hpp>

#include "where_clause.hpp"

namespace busbar::server::detail {

/// An EventFilter (Part 4, 7.22.3) that is checked once and then selects events and their fields.
class CompiledEventFilter {
public:
    /// Takes `filter` over. Good even if it selects fields that no event has, which are then null.
    /// Bad_EventFilterInvalid if it selects nothing, is too long or its whereClause is invalid.
    /// `result` gets the errors of clauses; it is unchanged if there are none.
    [[nodiscard]] StatusCode compile(const EventFilter& filter, EventFields& fields,
                                     const EventFilterLimits& limits, EventFilterResult& result);

    /// Called before each event: updates which fields are restricted by RolePermissions. Costs
    /// nothing while none change.
    void follow(EventFields& fields);
    /// True if a selectClause or the whereClause has a field that not every user may read.
    [[nodiscard]] bool has_guards() const { return has_guards_; }
    [[nodiscard]] bool matches(const RaisedEvent& event, const EventReader& reader)
    {
        return where_.matches(event, reader);
    }
    /// Returns one value for each selectClause.
    [[nodiscard]] Array<Variant> select(const RaisedEvent& event, const EventReader& reader) const;
    // For a reader with access to every field.

    [[nodiscard]] bool matches(const RaisedEvent& event, const model::AddressSpace& space)
    {
        return matches(event, EventReader{space});
    }
    [[nodiscard]] Array<Variant> select(const RaisedEvent& event,
                                        const model::AddressSpace& space) const
    {
        return select(event, EventReader{space});
    }
    /// Approximate memory in bytes.
    [[nodiscard]] std::size_t memory() const { return memory_; }

private:
    void look_up_guards(EventFields& fields);

    /// Without value for an invalid clause.
    std::vector<std::optional<FieldOperand>> select_;
    WhereClause where_;
    std::size_t memory_{0};
    bool has_guards_{false};
    /// The version of EventFields at the last lookup of guards.
    std::uint64_t version_{0};
};

} // namespace busbar::server::detail
