#include <cstdlib>
#include <memory>

#include <unistd.h>

#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "tool/nodes/node_feed.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"
#include "tool/stream/event_stream.hpp"
#include "tool/stream/watched_values.hpp"
#include "tool/watch/model.hpp"
#include "tool/watch/view.hpp"

namespace busbar::tool {

namespace {

struct WatchArguments {
    std::vector<std::string> nodes;
    std::vector<std::string> below;
    std::size_t limit{1'000};
    bool has_no_events{false};
    bool wants_lines{false};
    FeedSettings feed;
    StreamEnd end;
    RowFormat format;
};

struct Selection {
    std::vector<watch::Watched> nodes;
    /// A note about what is missing; may be empty.
    std::string note;
};

Selection select(Connection& connection, const WatchArguments& arguments)
{
    Selection selection;
    for (FeedNode& node : parse_feed(arguments.nodes)) {
        selection.nodes.push_back({node, node.text});
    }
    refuse_ambiguous(connection, arguments.nodes);
    if (!arguments.nodes.empty() && arguments.below.empty()) {
        return selection;
    }
    VariablesBelow found = variables_below(connection, arguments.below, arguments.limit);
    for (VariableBelow& variable : found.variables) {
        selection.nodes.push_back({std::move(variable.node), std::move(variable.name)});
    }
    if (selection.nodes.empty()) {
        throw Failure{Exit::Failed, "there are no Variables below",
                      "see what there is with `busbar browse`"};
    }
    if (found.left_out > 0) {
        selection.note = std::to_string(found.left_out) +
                         " more Variables are left out: --limit takes more of them";
    } else if (!found.is_complete) {
        selection.note = "the server has more nodes than could be browsed";
    }
    return selection;
}

void print_event(Context& context, const RowFormat& format, const Array<Variant>& fields)
{
    if (fields.size() != standard_event_fields.size() || format.is_set()) {
        return;
    }
    if (!context.options.is_json) {
        context.out.line(time_of_day(fields[0].value_or<DateTime>({})) + "  event " +
                         std::to_string(fields[1].value_or<std::uint16_t>(0)) + "  " +
                         plain_text(fields[2]) + "  " + plain_text(fields[3]));
        return;
    }
    JsonLine json;
    json.open_object().key("event").open_object();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        json.key(standard_event_fields[i]);
        append_json(json, fields[i], nullptr);
    }
    context.out.line(json.close_object().close_object().document());
}

Exit show_lines(Context& context, Connection& connection, const WatchArguments& arguments,
                const Selection& selection)
{
    if (!selection.note.empty()) {
        context.err.line("busbar: " + selection.note);
    }
    std::vector<FeedNode> nodes;
    for (const watch::Watched& watched : selection.nodes) {
        nodes.push_back(watched.node);
    }
    Stream stream{context, connection, arguments.end};
    WatchedValues lines{context,         connection,       stream,
                        arguments.feed,  std::move(nodes), WatchedValues::Printing::Lines,
                        arguments.format};
    if (!arguments.has_no_events) {
        lines.feed().add_events(
            event_item(NodeId{0, id::Server}),
            [&](const Array<Variant>& fields) { print_event(context, arguments.format, fields); },
            [](StatusCode) {}); // a server without events still has values
    }
    stream.run();
    return lines.exit();
}

/// Null where lines are shown: to a pipe, for a script, and on what is hardly a terminal.
std::unique_ptr<watch::Terminal> open_terminal(const Context& context,
                                               const WatchArguments& arguments)
{
    const char* const type = std::getenv("TERM");
    const bool is_simple = type == nullptr || std::string_view{type} == "dumb";
    // Lines of --verbose would be printed across the picture.
    const bool is_disturbed = context.options.is_verbose && context.err.is_terminal();
    if (arguments.wants_lines || context.options.is_json || arguments.format.is_set() ||
        is_simple || is_disturbed || !context.out.is_terminal() || ::isatty(STDIN_FILENO) != 1) {
        return nullptr;
    }
    return watch::Terminal::open(context.out.has_colour());
}

/// Adds to each node what the server says of it and a shorter name, and returns the settings.
watch::ViewSettings settings_of(Connection& connection, const WatchArguments& arguments,
                                Selection& selection)
{
    std::vector<std::string> names;
    std::vector<std::string> addresses;
    for (const watch::Watched& watched : selection.nodes) {
        names.push_back(watched.name);
        addresses.push_back(watched.node.address.text());
    }
    const auto facts = facts_of(connection, find_nodes(connection, addresses), FactsWanted::All);
    watch::ShortNames shorter = watch::short_names(names);
    for (std::size_t i = 0; i < selection.nodes.size(); ++i) {
        selection.nodes[i].facts = facts[i];
        selection.nodes[i].name = std::move(shorter.names[i]);
    }
    return {arguments.feed, arguments.end, !arguments.has_no_events, selection.note,
            shorter.folder};
}

Exit watch_nodes(Context& context, const WatchArguments& arguments)
{
    Connection connection{context, Connection::Endurance::Lasting};
    Selection selection = select(connection, arguments);
    if (auto terminal = open_terminal(context, arguments)) {
        const watch::ViewSettings settings = settings_of(connection, arguments, selection);
        return watch::View{context, connection, settings, selection.nodes, std::move(terminal)}
            .run();
    }
    return show_lines(context, connection, arguments, selection);
}

constexpr const char* watch_footer =
    "Keys: arrows, Page Up and Down, Home and End move; w or Enter writes the value,\n"
    "d shows all that is known of a variable, / filters by name, s sorts by name,\n"
    "value, age, status, r reverses that, p pauses, e shows events or not, ? lists\n"
    "the keys, Escape ends what was typed, the details or the filter, q quits. Names\n"
    "are without numbers of namespaces where these make no difference, numbers\n"
    "rounded to six digits. Lines instead of a view in a pipe, with --json, --csv,\n"
    "--format and --value, and where TERM is dumb.";

} // namespace

void add_watch(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("watch", "Shows values and events live, in a table.");
    const auto arguments = std::make_shared<WatchArguments>();
    command->add_option(
        "NODE", arguments->nodes,
        "server (optional), then Variables; all that the server has of its own by default");
    command->add_option("--below", arguments->below, "the Variables below a node")
        ->type_name("NODE")
        ->expected(1)
        ->take_all();
    command->add_option("--limit", arguments->limit, "Variables below nodes that are watched")
        ->check(CLI::Range(1, 1'000'000))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--no-events", arguments->has_no_events, "without the server's events");
    command->add_flag("--lines", arguments->wants_lines, "lines on a terminal, too");
    add_feed_options(*command, arguments->feed);
    add_stream_options(*command, arguments->end);
    add_format_options(*command, arguments->format);
    command->footer(watch_footer);
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->nodes, context.options);
        return watch_nodes(context, *arguments);
    });
}

} // namespace busbar::tool
