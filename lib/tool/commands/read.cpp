#include <memory>

#include "commands.hpp"
#include "tool/connection/failure.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/variable_facts.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/row_format.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value_lines.hpp"

namespace busbar::tool {

namespace {

struct ReadArguments {
    std::vector<std::string> nodes;
    std::string attribute{"Value"};
    std::string range;
    bool has_all{false};
    RowFormat format;
    ValueLimits limits;
};

/// The exit code for the statuses of several nodes.
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
                const std::vector<DataValue>& values, const Types& types,
                const std::vector<ValueFacts>& facts)
{
    JsonLine json;
    json.open_array();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        json.open_object().member("node", nodes[i].text);
        if (nodes[i].id) {
            json.member("nodeId", to_string(*nodes[i].id));
        }
        append_json(json, values[i], types, facts[i].data_type);
        append_candidates(json, nodes[i]);
        json.close_object();
    }
    out.line(json.close_array().document());
}

/// Returns the facts about the values of an attribute of each node.
std::vector<ValueFacts> facts_for(Connection& connection, const std::vector<NamedNode>& nodes,
                                  AttributeId attribute)
{
    if (attribute == AttributeId::Value) {
        return facts_of(connection, nodes, FactsWanted::All);
    }
    std::vector<ValueFacts> facts(nodes.size());
    for (ValueFacts& fact : facts) {
        fact.data_type = type_of(attribute);
    }
    return facts;
}

/// A DataType as people know it: "MachineMode (ns=4;s=Types/MachineMode)".
void name_data_type(Connection& connection, const DataValue& value, ValueText& text)
{
    if (const auto* const type = value.value.get_if<NodeId>(); type != nullptr) {
        const std::string name = type_names(connection, {*type}).front();
        text.text = name == text.text ? text.text : name + " (" + text.text + ")";
    }
}

std::string with_unit(const std::string& text, const std::string& unit)
{
    return unit.empty() ? text : text + " " + unit;
}

/// The results of a Read of several nodes.
struct ReadNodes {
    const std::vector<NamedNode>& nodes;
    const std::vector<DataValue>& values;
    const Types& types;
    const std::vector<ValueFacts>& facts;
};

void print(Context& context, Connection& connection, const ReadNodes& read, AttributeId attribute,
           const ValueLimits& limits)
{
    Table table{{{"NODE", 16, false, true}, {"VALUE", 20}, {"SOURCE TIME", 11}}};
    for (std::size_t i = 0; i < read.nodes.size(); ++i) {
        const DataValue& value = read.values[i];
        ValueText text =
            lines_of(value, read.types, limits, context.out.columns(), read.facts[i].data_type);
        if (attribute == AttributeId::DataType) {
            name_data_type(connection, value, text);
        }
        const bool is_bad = value.status.is_bad();
        if (value.status.is_uncertain()) {
            text.text += " (" + std::string{name(value.status)} + ")";
        }
        table.add({{safe(read.nodes[i].text)},
                   {is_bad ? text.text : with_unit(text.text, read.facts[i].unit),
                    style_of(value.status)},
                   {time_of_day(value.source_timestamp), Style::Dim}},
                  std::move(text.lines));
    }
    table.print(context.out);
}

void print_rows(Context& context, const std::vector<NamedNode>& nodes,
                const std::vector<DataValue>& values, const Types& types,
                const std::vector<ValueFacts>& facts, const RowFormat& format)
{
    RowWriter writer{context.out, format};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        writer.write({nodes[i].text, &values[i], facts[i].data_type, facts[i].unit}, types);
    }
}

/// Prints for each node without a value why it has none.
void print_reasons(Output& err, const std::vector<NamedNode>& nodes,
                   const std::vector<ValueFacts>& facts)
{
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (const std::string reason = reason_of_no_value(facts[i]); !reason.empty()) {
            err.line("busbar: " + safe(nodes[i].text) + ": " + reason);
        }
    }
}

Exit read_values(Context& context, Connection& connection, const ReadArguments& arguments)
{
    const auto attribute = find_attribute(arguments.attribute);
    if (!attribute) {
        const std::string meant = nearest(arguments.attribute, attribute_names());
        throw Failure{Exit::Usage, arguments.attribute + ": not an attribute",
                      meant.empty()
                          ? "attributes are Value, DataType, AccessLevel, DisplayName, ..."
                          : "did you mean " + meant + "?"};
    }
    const auto nodes = find_nodes(connection, arguments.nodes);
    const auto values = read_nodes(connection, nodes, *attribute, arguments.range);
    const auto facts = facts_for(connection, nodes, *attribute);
    if (nodes.size() == 1 && values.front().status.is_bad()) {
        throw value_failure(nodes.front(), values.front().status, facts.front());
    }
    const Types types = connection.types_of(values, ids_of(nodes));
    if (context.options.is_json) {
        print_json(context.out, nodes, values, types, facts);
        return exit_of_all(values);
    }
    if (arguments.format.is_set()) {
        print_rows(context, nodes, values, types, facts, arguments.format);
    } else {
        print(context, connection, {nodes, values, types, facts}, *attribute, arguments.limits);
    }
    print_reasons(context.err, nodes, facts);
    print_candidates(context.err, nodes);
    return exit_of_all(values);
}

/// One row of all attributes.
void add_attribute(Context& context, Connection& connection, AttributeId attribute,
                   const DataValue& value, const NodeId& data_type, const ValueLimits& limits,
                   Table& table)
{
    const bool is_value = attribute == AttributeId::Value;
    ValueText shown = lines_of(value, connection.types().types(), limits, context.out.columns(),
                               is_value ? data_type : type_of(attribute));
    if (attribute == AttributeId::DataType) {
        name_data_type(connection, value, shown);
    }
    table.add({{std::string{name(attribute)}}, {std::move(shown.text), style_of(value.status)}},
              std::move(shown.lines));
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
    const Types types = connection.types_of(values, std::vector<NodeId>(values.size(), node));
    const ValueFacts facts = facts_of(connection, {{text, node}}, FactsWanted::DataType).front();
    JsonLine json;
    json.open_object().member("node", text).key("attributes").open_object();
    Table table{{{"ATTRIBUTE"}, {"VALUE", 20}}};
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i].status == status::Bad_AttributeIdInvalid) {
            continue;
        }
        json.key(name(attributes[i])).open_object();
        append_json(json, values[i], types,
                    attributes[i] == AttributeId::Value ? facts.data_type : type_of(attributes[i]));
        json.close_object();
        add_attribute(context, connection, attributes[i], values[i], facts.data_type, limits,
                      table);
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
    command->add_option("NODE", arguments->nodes, "server (optional), then nodes")->required();
    command
        ->add_option("-a,--attribute", arguments->attribute, "attribute to read instead of Value")
        ->type_name("NAME");
    command->add_option("--range", arguments->range, "elements of arrays: 3, 0:9 or 1,0:2");
    command->add_flag("--all", arguments->has_all, "all attributes of the nodes");
    add_limit_option(*command, arguments->limits);
    add_format_options(*command, arguments->format);
    when_chosen(*command, run, [arguments](Context& context) {
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
    });
}

} // namespace busbar::tool
