#include <algorithm>
#include <charconv>
#include <memory>
#include <set>

#include <busbar/model/nodeset.hpp>

#include "commands.hpp"
#include "tool/nodes/remote_nodes.hpp"
#include "tool/nodes/space_builder.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool {

namespace {

struct ExportArguments {
    std::vector<std::string> name_space;
    std::string file;
};

/// The index that the user gave, or that of the URI.
std::uint16_t find_namespace(const std::vector<std::string>& namespaces, const std::string& text)
{
    const auto found = std::find(namespaces.begin(), namespaces.end(), text);
    std::size_t index = static_cast<std::size_t>(found - namespaces.begin());
    if (found == namespaces.end()) {
        const auto read = std::from_chars(text.data(), text.data() + text.size(), index);
        if (read.ec != std::errc{} || read.ptr != text.data() + text.size()) {
            index = namespaces.size();
        }
    }
    if (index == 0 || index >= namespaces.size()) {
        std::string known;
        for (std::size_t i = 1; i < namespaces.size(); ++i) {
            known += (i == 1 ? "" : ", ") + std::to_string(i) + " " + namespaces[i];
        }
        throw Failure{Exit::Usage, text + ": no namespace that can be exported",
                      "the server has " + known};
    }
    return static_cast<std::uint16_t>(index);
}

/// The model of the namespace, which requires those that its nodes refer to.
model::NodeSetModel model_of(const std::vector<RemoteNode>& nodes,
                             const std::vector<std::string>& namespaces, std::uint16_t index)
{
    std::set<std::uint16_t> required{0};
    for (const RemoteNode& node : nodes) {
        if (node.id.namespace_index() != index) {
            continue;
        }
        required.insert(node.get<NodeId>(AttributeId::DataType).namespace_index());
        for (const ReferenceDescription& reference : node.references) {
            // A namespace that only refers to this one is not required by it, but requires it.
            if (reference.is_forward || reference.reference_type_id.namespace_index() != 0) {
                required.insert(reference.node_id.node_id.namespace_index());
            }
            required.insert(reference.reference_type_id.namespace_index());
        }
    }
    required.erase(index);
    model::NodeSetModel model;
    model.uri = namespaces[index];
    for (const std::uint16_t other : required) {
        if (other < namespaces.size()) {
            model.required.emplace_back().uri = namespaces[other];
        }
    }
    return model;
}

void save(Context& context, const std::string& file, const std::string& text)
{
    if (file.empty() || file == "-") {
        context.out.write(text);
        return;
    }
    write_file(file, text);
}

void report(Context& context, const ExportArguments& arguments, const SpaceBuilder& builder,
            std::size_t count)
{
    const bool to_file = !arguments.file.empty() && arguments.file != "-";
    if (context.options.is_json && to_file) {
        JsonLine json;
        json.open_object().member("file", arguments.file);
        json.member("nodes", static_cast<std::int64_t>(count));
        json.key("leftOut").open_array();
        for (const NodeId& node : builder.left_out()) {
            json.text(to_string(node));
        }
        context.out.line(json.close_array().close_object().document());
        return;
    }
    context.err.line("busbar: " + std::to_string(count) + " nodes" +
                     (to_file ? " in " + arguments.file : ""));
    for (const NodeId& node : builder.left_out()) {
        context.err.line("busbar: left out, without parent or type: " + to_string(node));
    }
    for (const NodeId& node : builder.without_value()) {
        context.err.line("busbar: without value, which is not of its DataType: " + to_string(node));
    }
}

Exit export_namespace(Context& context, Connection& connection, const ExportArguments& arguments)
{
    const std::vector<std::string> namespaces = connection.client().server().namespaces;
    const std::uint16_t index = find_namespace(namespaces, arguments.name_space.front());
    const RemoteNodes remote = read_remote_nodes(
        context, connection, [&](const NodeId& id) { return id.namespace_index() == index; });
    const std::vector<RemoteNode>& nodes = remote.nodes;
    SpaceBuilder builder{namespaces};
    builder.add(nodes);
    model::NodeSetExtras extras;
    extras.models.push_back(model_of(nodes, namespaces, index));
    const std::uint16_t wanted[] = {index};
    const auto text = model::write_nodeset(builder.space(), wanted, extras);
    save(context, arguments.file, connection.value(text, "writing the NodeSet"));
    const auto count = std::count_if(nodes.begin(), nodes.end(), [&](const RemoteNode& node) {
        return node.id.namespace_index() == index &&
               builder.space().find(node.id) != model::no_node;
    });
    report(context, arguments, builder, static_cast<std::size_t>(count));
    if (!remote.is_complete) {
        context.err.line("busbar: some nodes of the server could not be browsed");
    }
    return remote.is_complete && builder.left_out().empty() ? Exit::Good : Exit::Partly;
}

} // namespace

void add_export(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("export", "Writes a namespace's nodes as NodeSet2 file.");
    const auto arguments = std::make_shared<ExportArguments>();
    command
        ->add_option("NAMESPACE", arguments->name_space,
                     "server (optional), then a namespace: index or URI")
        ->required();
    command->add_option("-o,--output", arguments->file, "instead of standard output")
        ->type_name("FILE");
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->name_space, context.options, 1);
        const bool is_only_url = arguments->name_space.front().starts_with("opc.tcp://");
        if (arguments->name_space.size() != 1 || is_only_url) {
            throw Failure{Exit::Usage, "one namespace is to be given",
                          "they are in `busbar read i=2255`"};
        }
        Connection connection{context};
        return export_namespace(context, connection, *arguments);
    });
}

} // namespace busbar::tool
