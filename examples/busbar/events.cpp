#include <memory>

#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "display_text.hpp"
#include "event_fields.hpp"
#include "nodes.hpp"
#include "stream.hpp"
#include "value.hpp"

namespace busbar::cli {

namespace {

struct EventsArguments {
    std::vector<std::string> node;
    std::vector<std::string> fields;
    std::uint16_t severity{0};
    StreamEnd end;
};

std::string padded(std::string text, std::size_t width)
{
    text = cut(text, width);
    return text + std::string(width - display_width(text), ' ');
}

void print(Output& out, const EventsArguments& arguments, const Array<Variant>& fields)
{
    const auto severity = fields[1].value_or<std::uint16_t>(0);
    std::string number = std::to_string(severity);
    number.insert(0, 8 - std::min<std::size_t>(8, number.size()), ' ');
    std::string line = padded(time_of_day(fields[0].value_or<DateTime>({})), 12) + "  " +
                       out.styled(event_style(severity), number) + "  " +
                       padded(plain_text(fields[2]), 20) + "  ";
    std::string rest = plain_text(fields[3]);
    for (std::size_t i = 0; i < arguments.fields.size(); ++i) {
        rest += "  " + safe(arguments.fields[i]) + "=" +
                plain_text(fields[standard_event_fields.size() + i]);
    }
    const std::size_t used = 12 + 2 + 8 + 2 + 20 + 2;
    out.line(line + cut(rest, std::max<std::size_t>(out.columns(), used + 12) - used));
}

void print_json(Output& out, const EventsArguments& arguments, const Array<Variant>& fields)
{
    JsonWriter json;
    json.open_object();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const bool is_standard = i < standard_event_fields.size();
        json.key(is_standard
                     ? standard_event_fields[i]
                     : std::string_view{arguments.fields[i - standard_event_fields.size()]});
        append_json(json, fields[i], nullptr);
    }
    out.line(json.close_object().document());
}

Exit follow(Context& context, Connection& connection, const EventsArguments& arguments)
{
    const std::size_t field_count = standard_event_fields.size() + arguments.fields.size();
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
    static_cast<void>(connection.value(
        subscriptions.add_items(subscription, {event_item(parse_address(arguments.node.front()),
                                                          arguments.fields, arguments.severity)}),
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
    const auto arguments = std::make_shared<EventsArguments>();
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
            refuse_ambiguous(connection, arguments->node);
            return follow(context, connection, *arguments);
        };
    });
}

} // namespace busbar::cli
