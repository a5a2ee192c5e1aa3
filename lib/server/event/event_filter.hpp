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

    [[nodiscard]] bool matches(const RaisedEvent& event, const model::AddressSpace& space)
    {
        return where_.matches(event, space);
    }
    /// One value for each selectClause.
    [[nodiscard]] Array<Variant> select(const RaisedEvent& event,
                                        const model::AddressSpace& space) const;
    /// About the bytes it takes.
    [[nodiscard]] std::size_t memory() const { return memory_; }

private:
    /// Without value where the clause was bad.
    std::vector<std::optional<FieldOperand>> select_;
    WhereClause where_;
    std::size_t memory_{0};
};

} // namespace busbar::server::detail
