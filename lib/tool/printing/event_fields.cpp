#include "event_fields.hpp"

#include <charconv>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

#include "display_text.hpp"
#include "value.hpp"

namespace busbar::tool {

namespace {

/// "2:Press/Force": names of a path, each with its namespace if it is not 0.
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

/// Up to two conditions, which all have to hold (Part 4, 7.7.3).
ContentFilter where_clause(const EventChoice& choice)
{
    ContentFilter filter;
    const bool has_severity = choice.severity > 0;
    const bool has_type = !choice.type.is_null();
    if (has_severity && has_type) { // the first of all elements is evaluated
        filter.elements.push_back(condition(FilterOperator::And, {element(1), element(2)}));
    }
    if (has_severity) {
        filter.elements.push_back(condition(
            FilterOperator::GreaterThanOrEqual,
            {ExtensionObject::from(operand("Severity")), literal(Variant{choice.severity})}));
    }
    if (has_type) {
        filter.elements.push_back(
            condition(FilterOperator::OfType, {literal(Variant{choice.type})}));
    }
    return filter;
}

EventFilter filter_of(const EventChoice& choice)
{
    EventFilter filter;
    for (const std::string_view field : standard_event_fields) {
        filter.select_clauses.push_back(operand(field));
    }
    for (const std::string& field : choice.fields) {
        filter.select_clauses.push_back(operand(field));
    }
    filter.where_clause = where_clause(choice);
    return filter;
}

} // namespace

client::ItemSettings event_item(client::NodeAddress node, const EventChoice& choice)
{
    client::ItemSettings item;
    item.node = std::move(node);
    item.attribute = AttributeId::EventNotifier;
    item.sampling_interval = decltype(item.sampling_interval){0};
    item.queue_size = 1'000;
    item.filter = ExtensionObject::from(filter_of(choice));
    return item;
}

std::string plain_text(const Variant& value)
{
    if (const auto* localized = value.get_if<LocalizedText>()) {
        return safe(localized->text.view());
    }
    if (const auto* text = value.get_if<String>()) {
        return safe(text->view());
    }
    return value.is_null() ? "-" : text_of(value, nullptr);
}

Style event_style(std::uint16_t severity)
{
    return severity >= 667 ? Style::Bad : severity >= 334 ? Style::Uncertain : Style::Plain;
}

} // namespace busbar::tool
