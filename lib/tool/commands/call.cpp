#include <memory>

#include <busbar/client/methods.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value_lines.hpp"
#include "tool/printing/value_type.hpp"

namespace busbar::tool {

namespace {

struct CallArguments {
    std::vector<std::string> words; // object, method, values
    ValueLimits limits;
};

/// Finds a method by node id or path, or by its name among the methods of the object.
NodeId find_method(Connection& connection, const NodeId& object, const std::string& text)
{
    if (client::NodeAddress::parse(text)) {
        return find_node(connection, text);
    }
    using Results = std::vector<BrowseResult>;
    const auto results = connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::browse(connection.client(), {client::children_of(object)}, std::move(done));
    });
    for (const ReferenceDescription& child : results.front().references) {
        const bool is_named =
            to_string(child.browse_name) == text || child.browse_name.name.view() == text;
        if (child.node_class == NodeClass::Method && is_named) {
            return child.node_id.node_id;
        }
    }
    throw Failure{status::Bad_MethodInvalid, text};
}

/// Reads the property InputArguments or OutputArguments; empty without it.
std::vector<Argument> arguments_of(Connection& connection, const NodeId& method,
                                   const std::string& property)
{
    const auto address = client::NodeAddress::path("/" + property, method);
    const auto nodes = find_nodes(connection, {address->text()});
    if (!nodes.front().id) {
        return {};
    }
    const auto values = read_nodes(connection, nodes);
    if (const StatusCode status = values.front().status; status.is_bad()) {
        throw Failure{status, property + " of the method"};
    }
    std::vector<Argument> arguments;
    if (const auto* objects = values.front().value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& object : *objects) {
            if (const auto* argument = object.get_if<Argument>()) {
                arguments.push_back(*argument);
            }
        }
    }
    return arguments;
}

/// "Speed (Double), Steps (Int32[])"; an argument without a name shows its place.
std::string names_of(Connection& connection, const std::vector<Argument>& arguments)
{
    std::string names;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const Argument& argument = arguments[i];
        const auto values =
            read_attributes(connection, argument.data_type, {AttributeId::BrowseName});
        const auto* const type = values.front().value.get_if<QualifiedName>();
        const std::string name =
            argument.name.empty() ? std::to_string(i + 1) + "." : argument.name.str();
        names += (i == 0 ? "" : ", ") + safe(name) + " (" +
                 safe(type == nullptr ? to_string(argument.data_type) : type->name.str()) +
                 (argument.value_rank >= 1 ? "[])" : ")");
    }
    return names;
}

CallMethodRequest request_for(Connection& connection, const CallArguments& arguments)
{
    CallMethodRequest request;
    request.object_id = find_node(connection, arguments.words[0]);
    request.method_id = find_method(connection, request.object_id, arguments.words[1]);
    const auto inputs = arguments_of(connection, request.method_id, "InputArguments");
    const std::size_t given = arguments.words.size() - 2;
    if (inputs.size() != given) {
        throw Failure{Exit::Usage,
                      arguments.words[1] + ": " + std::to_string(given) + " arguments instead of " +
                          std::to_string(inputs.size()),
                      inputs.empty() ? "it takes none"
                                     : "its arguments are: " + names_of(connection, inputs)};
    }
    for (std::size_t i = 0; i < given; ++i) {
        const auto type = value_type(connection, inputs[i].data_type, inputs[i].value_rank);
        request.input_arguments.push_back(
            parse_value(arguments.words[i + 2], type, inputs[i].name.str()));
    }
    return request;
}

void print(Context& context, const std::vector<Argument>& outputs, const CallMethodResult& result,
           const Types& types, const ValueLimits& limits)
{
    JsonLine json;
    json.open_object().member("status", result.status_code).key("outputs").open_array();
    Table table{{{"OUTPUT"}, {"VALUE", 20}}};
    for (std::size_t i = 0; i < result.output_arguments.size(); ++i) {
        const std::string name = i < outputs.size() ? outputs[i].name.str() : std::to_string(i + 1);
        json.open_object().member("name", name).key("value");
        append_json(json, result.output_arguments[i], types);
        json.close_object();
        ValueText text = lines_of(result.output_arguments[i], types, limits, context.out.columns());
        table.add({{safe(name)}, {std::move(text.text)}}, std::move(text.lines));
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().close_object().document());
    } else if (table.row_count() == 0) {
        context.out.line("done");
    } else {
        table.print(context.out);
    }
}

Exit call_method(Context& context, Connection& connection, const CallArguments& arguments)
{
    CallMethodRequest request = request_for(connection, arguments);
    const auto outputs = arguments_of(connection, request.method_id, "OutputArguments");
    const std::string operand = operand_of(request.object_id, request.method_id);
    const client::ExplainedCall result = call_explained(connection, std::move(request));
    if (result.status_code.is_bad()) {
        std::string what = arguments.words[1];
        for (std::size_t i = 0; i < result.input_argument_results.size(); ++i) {
            if (result.input_argument_results[i].is_bad()) {
                what += ": argument " + std::to_string(i + 1) + " " +
                        text_of(result.input_argument_results[i]);
            }
        }
        throw refused_by_server(result.status_code, what, result.additional_info, operand);
    }
    std::vector<DataValue> values;
    for (const Variant& output : result.output_arguments) {
        values.emplace_back().value = output;
    }
    print(context, outputs, result, connection.types_of(values), arguments.limits);
    return Exit::Good;
}

} // namespace

void add_call(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("call", "Calls a method of an object.");
    const auto arguments = std::make_shared<CallArguments>();
    command
        ->add_option("OBJECT METHOD VALUE", arguments->words,
                     "server (optional), an object, a method of it by node or name, its arguments")
        ->required();
    add_limit_option(*command, arguments->limits);
    when_chosen(*command, run, [arguments](Context& context) {
        take_url_before(arguments->words, context.options);
        if (arguments->words.size() < 2) {
            throw Failure{Exit::Usage, "no method is given", "busbar call OBJECT METHOD ..."};
        }
        check_addresses({arguments->words.front()});
        Connection connection{context};
        return call_method(context, connection, *arguments);
    });
}

} // namespace busbar::tool
