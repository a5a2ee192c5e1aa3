#include <memory>

#include "commands.hpp"
#include "tool/connection/usage.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value_lines.hpp"

namespace busbar::tool {

namespace {

struct ReadArguments {
    std::vector<std::string> nodes;
    std::string attribute{"Value"};
    std::string range;
    bool has_all{false};
    bool is_plain{false};
    ValueLimits limits;
};

/// What the statuses of several nodes make of the command.
Exit exit_of_all(const std::vector<DataValue>& values)
{
    const auto bad = std::count_if(values.begin(), values.end(),
                                   [](const DataValue& value) { return value.status.is_bad(); });
    if (bad == 0) {
        return Exit::Good;
    }
    return static_cast<std::size_t>(bad) == values.size() ? Exit::Failed : Exit::Partly;
}

void print_json(Output& out, const std::vector<NamedNode>& nodes,
                const std::vector<DataValue>& values, const Types& types)
{
    JsonLine json;
    json.open_array();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        json.open_object().member("node", nodes[i].text);
        if (nodes[i].id) {
            json.member("nodeId", to_string(*nodes[i].id));
        }
        append_json(json, values[i], types);
        append_candidates(json, nodes[i]);
        json.close_object();
    }
    out.line(json.close_array().document());
}

void print(Output& out, const std::vector<NamedNode>& nodes, const std::vector<DataValue>& values,
           const Types& types, const ValueLimits& limits)
{
    Table table{{{"NODE", 16, false, true}, {"VALUE", 20}, {"SOURCE TIME", 11}}};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        ValueText text = lines_of(values[i], types, limits, out.columns());
        table.add({{safe(nodes[i].text)},
                   {std::move(text.text), style_of(values[i].status)},
                   {time_of_day(values[i].source_timestamp), Style::Dim}},
                  std::move(text.lines));
    }
    table.print(out);
}

Exit read_values(Context& context, Connection& connection, const ReadArguments& arguments)
{
    const auto attribute = find_attribute(arguments.attribute);
    if (!attribute) {
        const std::string meant = nearest(arguments.attribute, attribute_names());
        throw Failure{Exit::Usage, arguments.attribute + ": no attribute",
                      meant.empty()
                          ? "attributes are Value, DataType, AccessLevel, DisplayName, ..."
                          : "perhaps " + meant + " is meant"};
    }
    const auto nodes = find_nodes(connection, arguments.nodes);
    const auto values = read_nodes(connection, nodes, *attribute, arguments.range);
    if (nodes.size() == 1 && values.front().status.is_bad()) {
        throw failure_of(nodes.front(), values.front().status);
    }
    const Types types = connection.types_of(values);
    if (context.options.is_json) {
        print_json(context.out, nodes, values, types);
        return exit_of_all(values);
    }
    if (arguments.is_plain) {
        for (const DataValue& value : values) {
            context.out.line(text_of(value, types));
        }
    } else {
        print(context.out, nodes, values, types, arguments.limits);
    }
    print_candidates(context.err, nodes);
    return exit_of_all(values);
}

/// All attributes that the node has.
Exit read_all(Context& context, Connection& connection, const std::string& text,
              const ValueLimits& limits)
{
    const NodeId node = find_node(connection, text);
    std::vector<AttributeId> attributes;
    for (std::uint32_t id = 1; id <= static_cast<std::uint32_t>(AttributeId::AccessLevelEx); ++id) {
        attributes.push_back(static_cast<AttributeId>(id));
    }
    const auto values = read_attributes(connection, node, attributes);
    if (values.front().status.is_bad()) {
        throw Failure{values.front().status, text};
    }
    const Types types = connection.types_of(values);
    JsonLine json;
    json.open_object().member("node", text).key("attributes").open_object();
    Table table{{{"ATTRIBUTE"}, {"VALUE", 20}}};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i].status == status::Bad_AttributeIdInvalid) {
            continue;
        }
        const std::string attribute{name(attributes[i])};
        json.key(attribute).open_object();
        append_json(json, values[i], types);
        json.close_object();
        const auto* class_number = values[i].value.get_if<std::int32_t>();
        const bool is_class = attributes[i] == AttributeId::NodeClass && class_number != nullptr;
        ValueText shown = lines_of(values[i], types, limits, context.out.columns());
        if (is_class) {
            shown.text = name(static_cast<NodeClass>(*class_number));
        }
        table.add({{attribute}, {std::move(shown.text), style_of(values[i].status)}},
                  std::move(shown.lines));
    }
    if (context.options.is_json) {
        context.out.line(json.close_object().close_object().document());
    } else {
        table.print(context.out);
    }
    return Exit::Good;
}

} // namespace

void add_read(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("read", "Reads values, or other attributes, of nodes.");
    const auto arguments = std::make_shared<ReadArguments>();
    command->add_option("NODE", arguments->nodes, "[URL] and nodes")->required();
    command->add_option("-a,--attribute", arguments->attribute, "instead of Value")
        ->type_name("NAME");
    command->add_option("--range", arguments->range, "elements of arrays: 3, 0:9 or 1,0:2");
    command->add_flag("--all", arguments->has_all, "all attributes of the nodes");
    add_limit_option(*command, arguments->limits);
    command->add_flag("--value", arguments->is_plain, "nothing but the values, one per line");
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            take_url_before(arguments->nodes, context.options);
            check_addresses(arguments->nodes);
            Connection connection{context};
            if (!arguments->has_all) {
                return read_values(context, connection, *arguments);
            }
            for (const std::string& node : arguments->nodes) {
                read_all(context, connection, node, arguments->limits);
            }
            return Exit::Good;
        };
    });
}

} // namespace busbar::tool
