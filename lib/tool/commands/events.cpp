#include <algorithm>
#include <memory>

#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"
#include "tool/stream/event_stream.hpp"

namespace busbar::tool {

namespace {

struct EventsArguments {
    std::vector<std::string> node;
    EventChoice choice;
    StreamEnd end;
};

void print(Output& out, const EventsArguments& arguments, const EventFields& fields)
{
    const auto severity = fields[1].value_or<std::uint16_t>(0);
    std::string number = std::to_string(severity);
    number.insert(0, 8 - std::min<std::size_t>(8, number.size()), ' ');
    const std::string line = padded(time_of_day(fields[0].value_or<DateTime>({})), 12) + "  " +
                             out.styled(event_style(severity), number) + "  " +
                             padded(plain_text(fields[2]), 20) + "  ";
    std::string rest = plain_text(fields[3]);
    for (std::size_t i = 0; i < arguments.choice.fields.size(); ++i) {
        rest += "  " + safe(arguments.choice.fields[i]) + "=" +
                plain_text(fields[standard_event_fields.size() + i]);
    }
    constexpr std::size_t used = 12 + 2 + 8 + 2 + 20 + 2;
    out.line(line + cut(rest, columns_left(out.columns(), used)));
}

Exit follow(Context& context, Connection& connection, const EventsArguments& arguments)
{
    follow_events(context, connection,
                  {.node = arguments.node.front(),
                   .choice = arguments.choice,
                   .end = arguments.end,
                   .title = "TIME          SEVERITY  SOURCE                MESSAGE"},
                  [&](const EventFields& fields) { print(context.out, arguments, fields); });
    return Exit::Good;
}

} // namespace

void add_events(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("events", "Shows events as they come, until Ctrl+C.");
    const auto arguments = std::make_shared<EventsArguments>();
    command->add_option("NODE", arguments->node,
                        "server (optional), then the node that notifies; the Server by default");
    command->add_option("-f,--field", arguments->choice.fields, "show one more: 2:Press/Force")
        ->type_name("PATH")
        ->expected(1)
        ->take_all();
    command->add_option("--severity", arguments->choice.severity, "only from this severity on")
        ->check(CLI::Range(0, 1'000))
        ->type_name("1-1000");
    add_stream_options(*command, arguments->end);
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->node, context.options);
        if (arguments->node.empty()) {
            arguments->node.push_back(to_string(NodeId{0, id::Server}));
        }
        check_addresses(arguments->node);
        Connection connection{context, Connection::Endurance::Lasting};
        refuse_ambiguous(connection, arguments->node);
        return follow(context, connection, *arguments);
    });
}

} // namespace busbar::tool
