#include "event_fields.hpp"

#include <busbar/client/event_filter.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>

#include "display_text.hpp"
#include "value.hpp"

namespace busbar::tool {

namespace {

/// The standard fields, then the user's own.
EventFilter filter_of(const EventChoice& choice)
{
    client::EventSelection selection;
    selection.fields.assign(standard_event_fields.begin(), standard_event_fields.end());
    selection.fields.insert(selection.fields.end(), choice.fields.begin(), choice.fields.end());
    selection.severity = choice.severity;
    selection.type = choice.type;
    return client::event_filter(selection);
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
