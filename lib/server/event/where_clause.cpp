#include "where_clause.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>

namespace busbar::server::detail {

namespace {

/// Maximum cost of evaluating one event: the characters that Like compares.
constexpr std::size_t max_steps = 100'000;

} // namespace

/// Checks element by element and adds valid ones to the clause.
class WhereClause::Compiler {
public:
    Compiler(WhereClause& clause, EventFields& fields, const EventFilterLimits& limits,
             std::size_t element_count)
        : clause_{clause}, fields_{fields}, limits_{limits}, element_count_{element_count}
    {
    }

    [[nodiscard]] ContentFilterElementResult add(const ContentFilterElement& element)
    {
        ContentFilterElementResult result;
        const FilterOperatorRule* const rule = find_operator(element.filter_operator);
        result.status_code = check(rule, element.filter_operands.size());
        const auto first = static_cast<std::uint32_t>(clause_.operands_.size());
        if (result.status_code.is_good()) {
            add_operands(element.filter_operands, result);
        }
        if (result.status_code.is_good() && element.filter_operator == FilterOperator::OfType) {
            check_type(element.filter_operands[0], result);
        }
        const auto count = static_cast<std::uint32_t>(clause_.operands_.size()) - first;
        clause_.elements_.push_back({rule, first, count, false});
        return result;
    }

private:
    [[nodiscard]] StatusCode check(const FilterOperatorRule* rule, std::size_t operand_count) const
    {
        if (rule == nullptr) {
            return status::Bad_FilterOperatorInvalid;
        }
        if (rule->evaluate == nullptr) {
            return status::Bad_FilterOperatorUnsupported;
        }
        const std::size_t most = std::min<std::size_t>(rule->max_operands, limits_.max_operands);
        return operand_count < rule->min_operands || operand_count > most
                   ? status::Bad_FilterOperandCountMismatch
                   : status::Good;
    }

    void add_operands(const Array<ExtensionObject>& operands, ContentFilterElementResult& result)
    {
        Array<StatusCode> codes;
        for (const ExtensionObject& operand : operands) {
            const StatusCode code = add_operand(operand);
            if (code.is_bad()) {
                result.status_code = status::Bad_FilterOperandInvalid;
            }
            codes.push_back(code);
        }
        if (result.status_code.is_bad()) {
            result.operand_status_codes = std::move(codes);
        }
    }

    /// An AttributeOperand is not allowed in filters of events (Part 4, 7.22.3).
    [[nodiscard]] StatusCode add_operand(const ExtensionObject& operand)
    {
        if (const auto* const literal = operand.get_if<LiteralOperand>()) {
            return add_literal(literal->value);
        }
        if (const auto* const element = operand.get_if<ElementOperand>()) {
            return add_element(element->index);
        }
        if (const auto* const field = operand.get_if<SimpleAttributeOperand>()) {
            return add_field(*field);
        }
        return status::Bad_FilterOperandInvalid;
    }

    [[nodiscard]] StatusCode add_literal(const Variant& value)
    {
        if (binary::encoded_size(value) > limits_.max_literal_size) {
            return status::Bad_FilterLiteralInvalid;
        }
        push(Source::Literal, clause_.literals_.size());
        clause_.literals_.push_back(value);
        return status::Good;
    }

    /// Part 4, 7.7.4.2: greater than the index of the element it is part of.
    [[nodiscard]] StatusCode add_element(std::uint32_t index)
    {
        if (index <= clause_.elements_.size() || index >= element_count_) {
            return status::Bad_FilterElementInvalid;
        }
        push(Source::Element, index);
        return status::Good;
    }

    [[nodiscard]] StatusCode add_field(const SimpleAttributeOperand& operand)
    {
        auto field = FieldOperand::create(operand, fields_, limits_.max_path_elements);
        if (!field) {
            return field.error();
        }
        push(Source::Field, clause_.fields_.size());
        clause_.fields_.push_back(*std::move(field));
        return status::Good;
    }

    /// Part 4, 7.7.3: the operand of OfType must resolve to an EventType. What the operand is in
    /// each event is not known here, except of a literal.
    void check_type(const ExtensionObject& operand, ContentFilterElementResult& result) const
    {
        const auto* const literal = operand.get_if<LiteralOperand>();
        if (literal == nullptr || is_event_type(fields_.space(), literal->value)) {
            return;
        }
        result.status_code = status::Bad_FilterOperandInvalid;
        result.operand_status_codes = {status::Bad_FilterOperandInvalid};
    }

    void push(Source source, std::size_t index)
    {
        clause_.operands_.push_back({source, static_cast<std::uint32_t>(index)});
    }

    WhereClause& clause_;
    EventFields& fields_;
    const EventFilterLimits& limits_;
    std::size_t element_count_;
};

bool WhereClause::compile(const ContentFilter& filter, EventFields& fields,
                          const EventFilterLimits& limits, ContentFilterResult& result)
{
    Compiler compiler{*this, fields, limits, filter.elements.size()};
    bool is_valid = true;
    for (const ContentFilterElement& element : filter.elements) {
        result.element_results.push_back(compiler.add(element));
        is_valid = is_valid && result.element_results.back().status_code.is_good();
    }
    if (is_valid) {
        mark_needed();
        results_.resize(elements_.size());
        parts_.resize(fields_.size());
    }
    return is_valid;
}

void WhereClause::mark_needed()
{
    if (!elements_.empty()) {
        elements_.front().is_needed = true;
    }
    for (const Element& element : elements_) {
        for (std::uint32_t i = 0; element.is_needed && i < element.operand_count; ++i) {
            const Operand operand = operands_[element.first_operand + i];
            if (operand.source == Source::Element) {
                elements_[operand.index].is_needed = true;
            }
        }
    }
}

bool WhereClause::take_guards(EventFields& fields)
{
    bool has_some = false;
    for (FieldOperand& field : fields_) {
        field.take_guards(fields);
        has_some = has_some || field.has_guards();
    }
    return has_some;
}

bool WhereClause::matches(const RaisedEvent& event, const EventReader& reader)
{
    if (elements_.empty()) {
        return true;
    }
    FilterContext context{reader.space, event.type(), max_steps};
    for (std::size_t i = elements_.size(); i-- > 0;) {
        const Element& element = elements_[i];
        if (!element.is_needed) {
            continue;
        }
        values_.clear();
        for (std::uint32_t k = 0; k < element.operand_count; ++k) {
            values_.push_back(&value(operands_[element.first_operand + k], event, reader));
        }
        results_[i] = element.rule->evaluate(context, values_);
    }
    return results_.front().value_or(false);
}

const Variant& WhereClause::value(Operand operand, const RaisedEvent& event,
                                  const EventReader& reader)
{
    switch (operand.source) {
    case Source::Literal:
        return literals_[operand.index];
    case Source::Element:
        return results_[operand.index];
    case Source::Field:
        break;
    }
    return fields_[operand.index].value_in_filter(event, reader, parts_[operand.index]);
}

} // namespace busbar::server::detail
