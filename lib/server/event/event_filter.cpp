#include "event_filter.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>

namespace busbar::server::detail {

namespace {

bool is_too_long(const EventFilter& filter, const EventFilterLimits& limits)
{
    return filter.select_clauses.size() > limits.max_select_clauses ||
           filter.where_clause.elements.size() > limits.max_elements;
}

/// Size of names and literals, and the same again for clauses and operands.
std::size_t memory_of(const EventFilter& filter)
{
    std::size_t operands = filter.select_clauses.size();
    for (const ContentFilterElement& element : filter.where_clause.elements) {
        operands += 1 + element.filter_operands.size();
    }
    constexpr std::size_t usual_guards = 4;
    return 2 * binary::encoded_size(filter) +
           operands * (sizeof(FieldOperand) + usual_guards * sizeof(FieldGuard));
}

} // namespace

StatusCode CompiledEventFilter::compile(const EventFilter& filter, EventFields& fields,
                                        const EventFilterLimits& limits, EventFilterResult& result)
{
    if (filter.select_clauses.empty() || is_too_long(filter, limits)) {
        return status::Bad_EventFilterInvalid;
    }
    memory_ = memory_of(filter);
    Array<StatusCode> codes;
    for (const SimpleAttributeOperand& clause : filter.select_clauses) {
        auto operand = FieldOperand::create(clause, fields, limits.max_path_elements);
        codes.push_back(operand ? status::Good : operand.error());
        select_.push_back(operand ? std::optional{*std::move(operand)} : std::nullopt);
    }
    ContentFilterResult where;
    const bool is_valid = where_.compile(filter.where_clause, fields, limits, where);
    if (!is_valid ||
        std::any_of(codes.begin(), codes.end(), [](StatusCode code) { return code.is_bad(); })) {
        result.select_clause_results = std::move(codes);
        result.where_clause_result = std::move(where);
    }
    look_up_guards(fields);
    return is_valid ? status::Good : status::Bad_EventFilterInvalid;
}

void CompiledEventFilter::follow(EventFields& fields)
{
    if (version_ != fields.version()) {
        look_up_guards(fields);
    }
}

void CompiledEventFilter::look_up_guards(EventFields& fields)
{
    version_ = fields.version();
    has_guards_ = where_.take_guards(fields);
    for (auto& operand : select_) {
        if (operand) {
            operand->take_guards(fields);
            has_guards_ = has_guards_ || operand->has_guards();
        }
    }
}

Array<Variant> CompiledEventFilter::select(const RaisedEvent& event,
                                           const EventReader& reader) const
{
    Array<Variant> values;
    values.reserve(select_.size());
    for (const auto& operand : select_) {
        Variant storage;
        values.push_back(operand ? operand->value(event, reader, storage) : Variant{});
    }
    return values;
}

} // namespace busbar::server::detail
