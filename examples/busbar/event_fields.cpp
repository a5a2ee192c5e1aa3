#include "event_fields.hpp"

#include <charconv>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

#include "display_text.hpp"
#include "value.hpp"

namespace busbar::cli {

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

EventFilter filter_of(const std::vector<std::string>& fields, std::uint16_t severity)
{
    EventFilter filter;
    for (const std::string_view field : standard_event_fields) {
        filter.select_clauses.push_back(operand(field));
    }
    for (const std::string& field : fields) {
        filter.select_clauses.push_back(operand(field));
    }
    if (severity > 0) {
        ContentFilterElement& element = filter.where_clause.elements.emplace_back();
        element.filter_operator = FilterOperator::GreaterThanOrEqual;
        element.filter_operands.push_back(ExtensionObject::from(operand("Severity")));
        LiteralOperand least;
        least.value = Variant{severity};
        element.filter_operands.push_back(ExtensionObject::from(least));
    }
    return filter;
}

} // namespace

client::ItemSettings event_item(client::NodeAddress node, const std::vector<std::string>& fields,
                                std::uint16_t severity)
{
    client::ItemSettings item;
    item.node = std::move(node);
    item.attribute = AttributeId::EventNotifier;
    item.sampling_interval = decltype(item.sampling_interval){0};
    item.queue_size = 1'000;
    item.filter = ExtensionObject::from(filter_of(fields, severity));
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

} // namespace busbar::cli
