#include <busbar/client/event_filter.hpp>

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::client {

namespace {

/// Reads "2:Press/2:Force": the names of a path, each with its namespace unless that is 0.
Array<QualifiedName> browse_path(std::string_view text)
{
    Array<QualifiedName> path;
    while (!text.empty()) {
        const std::string_view part = text.substr(0, text.find('/'));
        text.remove_prefix(std::min(part.size() + 1, text.size()));
        const std::size_t colon = part.find(':');
        std::uint16_t index = 0;
        const auto read = std::from_chars(part.data(), part.data() + part.size(), index);
        const bool has_index = colon != std::string_view::npos && read.ec == std::errc{} &&
                               read.ptr == part.data() + colon;
        path.emplace_back(has_index ? index : std::uint16_t{0},
                          String{has_index ? part.substr(colon + 1) : part});
    }
    return path;
}

SimpleAttributeOperand operand(std::string_view field)
{
    SimpleAttributeOperand operand;
    operand.type_definition_id = NodeId{0, id::BaseEventType};
    operand.browse_path = browse_path(field);
    operand.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    return operand;
}

ExtensionObject literal(Variant value)
{
    LiteralOperand operand;
    operand.value = std::move(value);
    return ExtensionObject::from(std::move(operand));
}

ExtensionObject element(std::uint32_t index)
{
    ElementOperand operand;
    operand.index = index;
    return ExtensionObject::from(operand);
}

ContentFilterElement condition(FilterOperator filter_operator,
                               std::initializer_list<ExtensionObject> operands)
{
    ContentFilterElement condition;
    condition.filter_operator = filter_operator;
    condition.filter_operands = operands;
    return condition;
}

/// Returns up to two conditions, both of which have to hold (Part 4, 7.7.3).
ContentFilter where_clause(const EventSelection& selection)
{
    ContentFilter filter;
    const bool has_severity = selection.severity > 0;
    const bool has_type = !selection.type.is_null();
    if (has_severity && has_type) { // the first of all elements is evaluated
        filter.elements.push_back(condition(FilterOperator::And, {element(1), element(2)}));
    }
    if (has_severity) {
        filter.elements.push_back(condition(
            FilterOperator::GreaterThanOrEqual,
            {ExtensionObject::from(operand("Severity")), literal(Variant{selection.severity})}));
    }
    if (has_type) {
        filter.elements.push_back(
            condition(FilterOperator::OfType, {literal(Variant{selection.type})}));
    }
    return filter;
}

} // namespace

EventFilter event_filter(const EventSelection& selection)
{
    EventFilter filter;
    for (const std::string& field : selection.fields) {
        filter.select_clauses.push_back(operand(field));
    }
    filter.where_clause = where_clause(selection);
    return filter;
}

} // namespace busbar::client
