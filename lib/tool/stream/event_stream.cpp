#include "event_stream.hpp"

#include <algorithm>

#include <busbar/client/event_filter.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>

#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

namespace {

void print_json(Output& out, const EventChoice& choice, const EventFields& fields)
{
    JsonLine json;
    json.open_object();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        json.key(i < standard_event_fields.size()
                     ? standard_event_fields[i]
                     : std::string_view{choice.fields[i - standard_event_fields.size()]});
        append_json(json, fields[i], nullptr);
    }
    out.line(json.close_object().document());
}

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

void follow_events(Context& context, Connection& connection, const EventStream& events,
                   const std::function<void(const EventFields&)>& show)
{
    const std::size_t field_count = standard_event_fields.size() + events.choice.fields.size();
    Stream stream{context, connection, events.end};
    auto handlers = stream.handlers();
    handlers.on_events = [&](std::span<const client::EventArrived> arrived) {
        for (const client::EventArrived& event : arrived) {
            stream.push([&, fields = event.fields] {
                if (fields.size() != field_count || !stream.count()) {
                    return;
                }
                context.options.is_json ? print_json(context.out, events.choice, fields)
                                        : show(fields);
            });
        }
    };
    handlers.on_item = [&](client::ItemHandle, const client::ItemStatus& item) {
        if (item.status.is_bad()) {
            stream.push([&, status = item.status] { throw Failure{status, events.node}; });
        }
    };
    auto& subscriptions = connection.client().subscriptions();
    const auto subscription =
        connection.value(subscriptions.create(client::SubscriptionSettings{}, std::move(handlers)),
                         "the subscription");
    static_cast<void>(
        connection.value(subscriptions.add_items(
                             subscription, {event_item(parse_address(events.node), events.choice)}),
                         "the monitored item"));
    if (!context.options.is_json) {
        context.out.line(context.out.styled(Style::Bold, events.title));
    }
    stream.run();
}

std::string padded(std::string_view text, std::size_t columns)
{
    const std::string part = cut(text, columns);
    return part + std::string(columns - display_width(part), ' ');
}

std::size_t columns_left(std::size_t columns, std::size_t used)
{
    constexpr std::size_t least = 12;
    return std::max(columns, used + least) - used;
}

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
