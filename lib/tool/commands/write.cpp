#include <memory>

#include <busbar/client/attributes.hpp>

#include "commands.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"
#include "tool/printing/value_type.hpp"

namespace busbar::tool {

namespace {

struct WriteArguments {
    std::vector<std::string> nodes_and_values;
    std::string type;
    std::string range;
    bool is_merged{false};
};

/// Reads a value from its text; a structure that is not complete has a hint of its own.
Variant value_of(const std::string& text, const TypeOfValue& type, const std::string& node,
                 const Variant* base)
{
    try {
        return parse_value(text, type, node, base);
    } catch (Failure& failure) {
        const bool is_structure = type.type != nullptr && type.type->is_structure();
        const std::string_view what{failure.what()};
        if (is_structure && base == nullptr &&
            what.find("not complete") != std::string_view::npos) {
            failure.hint = "name all fields, or have the others stay as they are with --merge";
        }
        throw;
    }
}

/// The values as the DataTypes of their nodes, or --type, have them.
std::vector<WriteValue> values_of(Connection& connection, const std::vector<NamedNode>& nodes,
                                  const WriteArguments& arguments)
{
    const auto data_types = read_nodes(connection, nodes, AttributeId::DataType);
    const auto ranks = read_nodes(connection, nodes, AttributeId::ValueRank);
    std::vector<DataValue> now;
    if (arguments.is_merged) {
        now = read_nodes(connection, nodes);
    }
    std::vector<WriteValue> values;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].id) {
            continue;
        }
        // A range may be one element or more: the text tells.
        const std::int32_t rank =
            arguments.range.empty() ? ranks[i].value.value_or<std::int32_t>(-2) : -2;
        const TypeOfValue type =
            arguments.type.empty()
                ? value_type(connection, data_types[i].value.value_or<NodeId>({}), rank)
                : value_type(arguments.type, -2);
        DataValue value;
        if (arguments.is_merged && now[i].status.is_bad()) {
            throw Failure{now[i].status, nodes[i].text + ": reading what it has now"};
        }
        value.value = value_of(arguments.nodes_and_values[2 * i + 1], type, nodes[i].text,
                               arguments.is_merged ? &now[i].value : nullptr);
        values.push_back(
            client::value_for(*nodes[i].id, std::move(value), AttributeId::Value, arguments.range));
    }
    return values;
}

std::vector<client::ExplainedWrite>
write(Connection& connection, const std::vector<NamedNode>& nodes, std::vector<WriteValue> values)
{
    using Results = std::vector<client::ExplainedWrite>;
    Results written;
    if (!values.empty()) {
        written = connection.wait_for<Results>([&](std::function<void(Results)> done) {
            client::write_explained(connection.client(), std::move(values), std::move(done));
        });
    }
    auto next = written.begin();
    Results results;
    for (const NamedNode& node : nodes) {
        results.push_back(node.id ? std::move(*next++)
                                  : client::ExplainedWrite{node.id.error(), {}});
    }
    return results;
}

/// The server's name for a value in its additionalInfo.
std::string operand_of(const NodeId& node)
{
    return to_string(node) + ", attribute 13";
}

void print(Context& context, const std::vector<NamedNode>& nodes,
           const std::vector<client::ExplainedWrite>& results)
{
    std::vector<std::string> reasons;
    JsonLine json;
    json.open_array();
    Table table{{{"NODE", 16, false, true}, {"STATUS", 20}}};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const StatusCode status = results[i].status_code;
        const std::string_view reason =
            nodes[i].id ? reason_in(results[i].additional_info, operand_of(*nodes[i].id))
                        : std::string_view{};
        json.open_object().member("node", nodes[i].text).member("status", status);
        if (!reason.empty()) {
            json.member("reason", reason);
            reasons.push_back(safe(nodes[i].text) + ": " + safe(reason));
        }
        append_candidates(json, nodes[i]);
        json.close_object();
        table.add({{safe(nodes[i].text)}, {text_of(status), style_of(status)}});
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else {
        table.print(context.out);
        for (const std::string& reason : reasons) {
            context.err.line("busbar: " + reason);
        }
        print_candidates(context.err, nodes);
    }
}

Exit write_values(Context& context, Connection& connection, const WriteArguments& arguments)
{
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < arguments.nodes_and_values.size(); i += 2) {
        texts.push_back(arguments.nodes_and_values[i]);
    }
    const auto nodes = find_nodes(connection, texts);
    const auto results = write(connection, nodes, values_of(connection, nodes, arguments));
    const auto bad =
        std::count_if(results.begin(), results.end(), [](const client::ExplainedWrite& result) {
            return result.status_code.is_bad();
        });
    if (nodes.size() == 1 && bad == 1) {
        const client::ExplainedWrite& result = results.front();
        if (!nodes.front().id) {
            throw failure_of(nodes.front(), result.status_code);
        }
        throw refused_by_server(result.status_code, nodes.front().text, result.additional_info,
                                operand_of(*nodes.front().id));
    }
    print(context, nodes, results);
    return bad == 0                                        ? Exit::Good
           : static_cast<std::size_t>(bad) == nodes.size() ? Exit::Failed
                                                           : Exit::Partly;
}

constexpr const char* write_footer =
    "Values are 42, true, any text, 2026-11-21T06:00:00Z, base64 or 0x00FF for bytes;\n"
    "arrays are [1, 2], with texts in quotes; structures {\"Name\": value, ...},\n"
    "with all fields, or with --merge some of them. Enumerations take a name or\n"
    "number, times of a PLC T#1s500ms, TOD#06:00:00, D#2026-11-21 or\n"
    "DT#2026-11-21-06:00:00.";

} // namespace

void add_write(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("write", "Writes values of nodes.");
    const auto arguments = std::make_shared<WriteArguments>();
    command
        ->add_option("NODE VALUE", arguments->nodes_and_values,
                     "server (optional), then nodes with values")
        ->required();
    command->add_option("--type", arguments->type, "instead of the node's DataType: Int16, ...")
        ->type_name("NAME");
    command->add_option("--range", arguments->range, "elements of arrays: 3, 0:9 or 1,0:2");
    command->add_flag("--merge", arguments->is_merged,
                      "read structures first: fields that are not given stay as they are");
    command->footer(write_footer);
    when_chosen(*command, run, [arguments](Context& context) {
        take_url_before(arguments->nodes_and_values, context.options);
        if (arguments->nodes_and_values.size() % 2 != 0) {
            throw Failure{Exit::Usage, "a node has no value", "busbar write NODE VALUE"};
        }
        for (std::size_t i = 0; i < arguments->nodes_and_values.size(); i += 2) {
            check_addresses({arguments->nodes_and_values[i]});
        }
        Connection connection{context};
        return write_values(context, connection, *arguments);
    });
}

} // namespace busbar::tool
