#pragma once

#include <cstdint>
#include <vector>

#include <busbar/server/event_limits.hpp>
#include <busbar/types/filter.hpp>

#include "field_operand.hpp"
#include "filter_operators.hpp"

namespace busbar::server::detail {

/// The whereClause of an EventFilter, a ContentFilter (Part 4, 7.7): checked and parsed once, then
/// evaluated for each event without allocating, except for values that must be converted.
///
/// An element refers only to later elements (Part 4, 7.7.4.2). So one pass through the list from
/// its end evaluates each element once, however often others refer to it.
class WhereClause {
public:
    /// Takes `filter` over; false if it is invalid, with the reasons in `result`: of an element
    /// Bad_FilterOperatorInvalid, Bad_FilterOperatorUnsupported, Bad_FilterOperandCountMismatch or
    /// Bad_FilterOperandInvalid; of an operand the latter, Bad_FilterElementInvalid,
    /// Bad_FilterLiteralInvalid or the error of FieldOperand::create.
    [[nodiscard]] bool compile(const ContentFilter& filter, EventFields& fields,
                               const EventFilterLimits& limits, ContentFilterResult& result);

    /// Returns true if the first element is true, or if there is none; NULL counts as false.
    [[nodiscard]] bool matches(const RaisedEvent& event, const EventReader& reader);
    /// See FieldOperand; returns true if a field has guards.
    bool take_guards(EventFields& fields);

private:
    enum class Source : std::uint8_t { Literal, Element, Field };

    /// The source of a value: the list and the place in it.
    struct Operand {
        Source source;
        std::uint32_t index;
    };
    struct Element {
        const FilterOperatorRule* rule{nullptr};
        std::uint32_t first_operand{0};
        std::uint32_t operand_count{0};
        /// The first element needs it, directly or not; others are ignored (Part 4, 7.7.1).
        bool is_needed{false};
    };
    class Compiler;

    void mark_needed();
    [[nodiscard]] const Variant& value(Operand operand, const RaisedEvent& event,
                                       const EventReader& reader);

    std::vector<Element> elements_;
    std::vector<Operand> operands_;
    std::vector<Variant> literals_;
    std::vector<FieldOperand> fields_;
    // Valid during evaluation: results of elements, parts of fields, operands of one element.
    std::vector<Variant> results_;
    std::vector<Variant> parts_;
    std::vector<const Variant*> values_;
};

} // namespace busbar::server::detail
