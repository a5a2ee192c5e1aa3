#pragma once

#include <busbar/server/event_limits.hpp>

#include "where_clause.hpp"

namespace busbar::server::detail {

/// An EventFilter (Part 4, 7.22.3) that was checked once and then chooses events and their fields.
class CompiledEventFilter {
public:
    /// Takes `filter` over. Good also if it selects fields that no event has, which are null then.
    /// Bad_EventFilterInvalid if it selects nothing, is too long or its whereClause is not valid.
    /// `result` has what is wrong with the clauses; it stays as it is if nothing is.
    [[nodiscard]] StatusCode compile(const EventFilter& filter, EventFields& fields,
                                     const EventFilterLimits& limits, EventFilterResult& result);

    /// Before each event: knows whose RolePermissions fields take. Costs nothing while none change.
    void follow(EventFields& fields);
    /// A selectClause or the whereClause has a field that not everybody may read.
    [[nodiscard]] bool has_guards() const { return has_guards_; }
    [[nodiscard]] bool matches(const RaisedEvent& event, const EventReader& reader)
    {
        return where_.matches(event, reader);
    }
    /// One value for each selectClause.
    [[nodiscard]] Array<Variant> select(const RaisedEvent& event, const EventReader& reader) const;
    // For somebody who may read every field.

    [[nodiscard]] bool matches(const RaisedEvent& event, const model::AddressSpace& space)
    {
        return matches(event, EventReader{space});
    }
    [[nodiscard]] Array<Variant> select(const RaisedEvent& event,
                                        const model::AddressSpace& space) const
    {
        return select(event, EventReader{space});
    }
    /// About the bytes it takes.
    [[nodiscard]] std::size_t memory() const { return memory_; }

private:
    void look_up_guards(EventFields& fields);

    /// Without value where the clause was bad.
    std::vector<std::optional<FieldOperand>> select_;
    WhereClause where_;
    std::size_t memory_{0};
    bool has_guards_{false};
    /// Of the EventFields when the guards were looked up.
    std::uint64_t version_{0};
};

} // namespace busbar::server::detail
