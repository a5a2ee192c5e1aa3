#include <array>
#include <charconv>
#include <memory>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "display_text.hpp"
#include "nodes.hpp"
#include "stream.hpp"
#include "value.hpp"

namespace busbar::cli {

namespace {

struct Arguments {
    std::vector<std::string> node;
    std::vector<std::string> fields;
    std::uint16_t severity{0};
    StreamEnd end;
};

/// What is asked for always (Part 5, 6.4.2); the user's own fields come behind.
constexpr std::array<std::string_view, 6> standard_fields{"Time",    "Severity",  "SourceName",
                                                          "Message", "EventType", "EventId"};

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

EventFilter filter_of(const Arguments& arguments)
{
    EventFilter filter;
    for (const std::string_view field : standard_fields) {
        filter.select_clauses.push_back(operand(field));
    }
    for (const std::string& field : arguments.fields) {
        filter.select_clauses.push_back(operand(field));
    }
    if (arguments.severity > 0) {
        ContentFilterElement& element = filter.where_clause.elements.emplace_back();
        element.filter_operator = FilterOperator::GreaterThanOrEqual;
        element.filter_operands.push_back(ExtensionObject::from(operand("Severity")));
        LiteralOperand least;
        least.value = Variant{arguments.severity};
        element.filter_operands.push_back(ExtensionObject::from(least));
    }
    return filter;
}

/// Text without quotes for what is a text.
std::string plain(const Variant& value)
{
    if (const auto* localized = value.get_if<LocalizedText>()) {
        return safe(localized->text.view());
    }
    if (const auto* text = value.get_if<String>()) {
        return safe(text->view());
    }
    return value.is_null() ? "-" : text_of(value, nullptr);
}

std::string padded(std::string text, std::size_t width)
{
    text = cut(text, width);
    return text + std::string(width - display_width(text), ' ');
}

Style style_of_severity(std::uint16_t severity)
{
    return severity >= 667 ? Style::Bad : severity >= 334 ? Style::Uncertain : Style::Plain;
}

void print(Output& out, const Arguments& arguments, const Array<Variant>& fields)
{
    const auto severity = fields[1].value_or<std::uint16_t>(0);
    std::string number = std::to_string(severity);
    number.insert(0, 8 - std::min<std::size_t>(8, number.size()), ' ');
    std::string line = padded(time_of_day(fields[0].value_or<DateTime>({})), 12) + "  " +
                       out.styled(style_of_severity(severity), number) + "  " +
                       padded(plain(fields[2]), 20) + "  ";
    std::string rest = plain(fields[3]);
    for (std::size_t i = 0; i < arguments.fields.size(); ++i) {
        rest += "  " + safe(arguments.fields[i]) + "=" + plain(fields[standard_fields.size() + i]);
    }
    const std::size_t used = 12 + 2 + 8 + 2 + 20 + 2;
    out.line(line + cut(rest, std::max<std::size_t>(out.columns(), used + 12) - used));
}

void print_json(Output& out, const Arguments& arguments, const Array<Variant>& fields)
{
    JsonWriter json;
    json.open_object();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const bool is_standard = i < standard_fields.size();
        json.key(is_standard ? standard_fields[i]
                             : std::string_view{arguments.fields[i - standard_fields.size()]});
        append_json(json, fields[i], nullptr);
    }
    out.line(json.close_object().document());
}

client::ItemSettings item_of(const Arguments& arguments)
{
    client::ItemSettings item;
    item.node = parse_address(arguments.node.front());
    item.attribute = AttributeId::EventNotifier;
    item.sampling_interval = decltype(item.sampling_interval){0};
    item.queue_size = 1'000;
    item.filter = ExtensionObject::from(filter_of(arguments));
    return item;
}

Exit follow(Context& context, Connection& connection, const Arguments& arguments)
{
    const std::size_t field_count = standard_fields.size() + arguments.fields.size();
    Stream stream{context, connection, arguments.end};
    auto handlers = stream.handlers([&](client::ItemHandle) { return arguments.node.front(); });
    handlers.on_events = [&](std::span<const client::EventArrived> events) {
        for (const client::EventArrived& event : events) {
            stream.push([&, fields = event.fields] {
                if (fields.size() != field_count || !stream.count()) {
                    return;
                }
                context.options.is_json ? print_json(context.out, arguments, fields)
                                        : print(context.out, arguments, fields);
            });
        }
    };
    handlers.on_item = [&](client::ItemHandle, const client::ItemStatus& item) {
        if (item.status.is_bad()) {
            stream.push([&, status = item.status] {
                throw Failure{status, arguments.node.front()};
            });
        }
    };
    auto& subscriptions = connection.client().subscriptions();
    const auto subscription =
        connection.value(subscriptions.create(client::SubscriptionSettings{}, std::move(handlers)),
                         "the subscription");
    static_cast<void>(connection.value(subscriptions.add_items(subscription, {item_of(arguments)}),
                                       "the monitored item"));
    if (!context.options.is_json) {
        context.out.line(context.out.styled(
            Style::Bold, "TIME          SEVERITY  SOURCE                MESSAGE"));
    }
    stream.run();
    return Exit::Good;
}

} // namespace

void add_events(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("events", "Shows events as they come, until Ctrl+C.");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("NODE", arguments->node,
                        "[URL] and the node that notifies; the Server by default");
    command->add_option("-f,--field", arguments->fields, "show one more: 2:Press/Force")
        ->type_name("PATH")
        ->expected(1)
        ->take_all();
    command->add_option("--severity", arguments->severity, "only from this severity on")
        ->check(CLI::Range(0, 1'000))
        ->type_name("1-1000");
    add_stream_options(*command, arguments->end);
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            take_url(arguments->node, context.options);
            if (arguments->node.empty()) {
                arguments->node.push_back(to_string(NodeId{0, id::Server}));
            }
            check_addresses(arguments->node);
            Connection connection{context, Connection::Endurance::Lasting};
            return follow(context, connection, *arguments);
        };
    });
}

} // namespace busbar::cli
