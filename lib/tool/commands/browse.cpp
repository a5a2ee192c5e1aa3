#include <memory>

#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/variable_facts.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

namespace {

struct BrowseArguments {
    std::vector<std::string> node;
    std::size_t depth{2};
    bool has_values{false};
    bool has_references{false};
};

using client::BrowsedTree;
using client::TreeNode;

/// A browsed tree with the children of each node and, if wanted, the values of Variables.
struct Forest {
    BrowsedTree tree;
    std::vector<std::vector<std::size_t>> children;
    std::vector<DataValue> values; // empty if they are not wanted
    std::vector<ValueFacts> facts; // the same
    Types types;
};

Forest browse_forest(Connection& connection, const NodeId& root, const BrowseArguments& arguments)
{
    client::TreeLimits limits;
    limits.max_depth = arguments.depth;
    Forest forest;
    forest.tree = connection.wait_for<BrowsedTree>([&](std::function<void(BrowsedTree)> done) {
        client::browse_tree(connection.client(), {root}, client::children_of(root), std::move(done),
                            limits);
    });
    forest.children.resize(forest.tree.nodes.size());
    std::vector<NamedNode> variables;
    for (std::size_t i = 0; i < forest.tree.nodes.size(); ++i) {
        const TreeNode& node = forest.tree.nodes[i];
        if (node.parent != TreeNode::no_parent) {
            forest.children[node.parent].push_back(i);
        }
        const bool is_variable = node.reference.node_class == NodeClass::Variable;
        variables.push_back({"", is_variable ? Result<NodeId>{node.reference.node_id.node_id}
                                             : fail(StatusCode{})});
    }
    if (arguments.has_values) {
        forest.values = read_nodes(connection, variables);
        forest.facts = facts_of(connection, variables, FactsWanted::DataType);
        forest.types = connection.types_of(forest.values, ids_of(variables));
    }
    return forest;
}

void append_json(JsonLine& json, const Forest& forest, std::size_t index)
{
    const TreeNode& node = forest.tree.nodes[index];
    const ReferenceDescription& reference = node.reference;
    json.open_object().member("nodeId", to_string(reference.node_id));
    if (node.parent != TreeNode::no_parent) {
        json.member("browseName", to_string(reference.browse_name));
        json.member("displayName", reference.display_name.text.view());
        json.member("nodeClass", name(reference.node_class));
        json.member("referenceType", to_string(reference.reference_type_id));
        if (!reference.type_definition.node_id.is_null()) {
            json.member("typeDefinition", to_string(reference.type_definition));
        }
    }
    if (!forest.values.empty() && reference.node_class == NodeClass::Variable) {
        append_json(json, forest.values[index], forest.types, forest.facts[index].data_type);
    } else if (node.status.is_bad()) {
        json.member("status", node.status);
    }
    json.key("children").open_array();
    for (const std::size_t child : forest.children[index]) {
        append_json(json, forest, child);
    }
    json.close_array().close_object();
}

/// Draws a tree, depth first.
class TreePrinter {
public:
    TreePrinter(const Output& out, const Forest& forest, std::string root)
        : forest_{&forest}, root_{std::move(root)}, is_unicode_{out.has_unicode()}, table_{columns(
                                                                                        forest)}
    {
        add(0, "", "");
    }
    [[nodiscard]] const Table& table() const { return table_; }

private:
    static std::vector<Column> columns(const Forest& forest)
    {
        std::vector<Column> columns{{"NAME", 30}, {"CLASS"}, {"NODE ID", 16}};
        if (!forest.values.empty()) {
            columns.push_back({"VALUE", 12});
        }
        return columns;
    }
    void add(std::size_t index, const std::string& branch, const std::string& below)
    {
        const TreeNode& node = forest_->tree.nodes[index];
        const bool is_root = node.parent == TreeNode::no_parent;
        const std::string label = is_root ? root_ : safe(to_string(node.reference.browse_name));
        const std::string problem = node.status.is_bad() ? " " + text_of(node.status) : "";
        std::vector<Cell> row{
            {branch + label + problem, node.status.is_bad() ? Style::Bad : Style::Plain},
            {is_root ? "" : std::string{name(node.reference.node_class)}, Style::Dim},
            {safe(to_string(node.reference.node_id))}};
        if (!forest_->values.empty()) {
            const bool has_value = node.reference.node_class == NodeClass::Variable;
            const DataValue& value = forest_->values[index];
            const ValueHints hints{forest_->facts[index].data_type};
            row.push_back(has_value
                              ? Cell{text_of(value, forest_->types, hints), style_of(value.status)}
                              : Cell{});
        }
        table_.add(std::move(row));
        const auto& children = forest_->children[index];
        for (const std::size_t child : children) {
            const bool is_last = child == children.back();
            const char* const line =
                is_unicode_ ? (is_last ? "└─ " : "├─ ") : (is_last ? "`- " : "|- ");
            const char* const bar = is_last ? "   " : is_unicode_ ? "│  " : "|  ";
            add(child, below + line, below + bar);
        }
    }

    const Forest* forest_;
    std::string root_;
    bool is_unicode_;
    Table table_;
};

Exit show_tree(Context& context, Connection& connection, const NodeId& root,
               const BrowseArguments& arguments)
{
    const Forest forest = browse_forest(connection, root, arguments);
    const TreeNode& first = forest.tree.nodes.front();
    if (first.status.is_bad()) {
        throw Failure{first.status, arguments.node.front()};
    }
    if (context.options.is_json) {
        JsonLine json;
        append_json(json, forest, 0);
        context.out.line(json.document());
    } else {
        TreePrinter{context.out, forest, safe(arguments.node.front())}.table().print(context.out);
    }
    const bool has_failed = std::any_of(forest.tree.nodes.begin(), forest.tree.nodes.end(),
                                        [](const TreeNode& node) { return node.status.is_bad(); });
    return has_failed ? Exit::Partly : Exit::Good;
}

/// "HasComponent" of namespace 0 types; the node id of others.
std::string type_name(Connection& connection, const NodeId& type)
{
    const auto values = read_attributes(connection, type, {AttributeId::BrowseName});
    const auto* found = values.front().value.get_if<QualifiedName>();
    return found == nullptr ? to_string(type) : to_string(*found);
}

void print_references(Context& context, Connection& connection,
                      const Array<ReferenceDescription>& references)
{
    JsonLine json;
    json.open_array();
    Table table{{{"REFERENCE", 12}, {"NAME", 16}, {"CLASS"}, {"NODE ID", 16}}};
    std::unordered_map<NodeId, std::string> types;
    for (const ReferenceDescription& reference : references) {
        auto [type, is_new] = types.try_emplace(reference.reference_type_id);
        if (is_new) {
            type->second = type_name(connection, reference.reference_type_id);
        }
        json.open_object().member("referenceType", type->second);
        json.member("isForward", reference.is_forward);
        json.member("nodeId", to_string(reference.node_id));
        json.member("browseName", to_string(reference.browse_name));
        json.member("nodeClass", name(reference.node_class)).close_object();
        table.add({{(reference.is_forward ? "" : "<- ") + safe(type->second)},
                   {safe(to_string(reference.browse_name))},
                   {std::string{name(reference.node_class)}, Style::Dim},
                   {safe(to_string(reference.node_id))}});
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else {
        table.print(context.out);
    }
}

Exit show_references(Context& context, Connection& connection, const NodeId& node,
                     const BrowseArguments& arguments)
{
    BrowseDescription description = client::children_of(node);
    description.browse_direction = BrowseDirection::Both;
    description.reference_type_id = NodeId{0, id::References};
    using Results = std::vector<BrowseResult>;
    const auto results = connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::browse(connection.client(), {description}, std::move(done));
    });
    if (results.front().status_code.is_bad()) {
        throw Failure{results.front().status_code, arguments.node.front()};
    }
    print_references(context, connection, results.front().references);
    return results.front().status_code.is_good() ? Exit::Good : Exit::Partly;
}

} // namespace

void add_browse(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("browse", "Shows the tree of nodes below a node.");
    const auto arguments = std::make_shared<BrowseArguments>();
    command->add_option("NODE", arguments->node,
                        "server (optional), then a node; /Objects by default");
    command->add_option("-d,--depth", arguments->depth, "levels below the node")
        ->check(CLI::Range(0, 100))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--values", arguments->has_values, "with the values of Variables");
    command->add_flag("--references", arguments->has_references,
                      "all references of the node, in both directions, instead of the tree");
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->node, context.options);
        if (arguments->node.empty()) {
            arguments->node.emplace_back("/Objects");
        }
        check_addresses(arguments->node);
        Connection connection{context};
        const NodeId node = find_node(connection, arguments->node.front());
        return arguments->has_references ? show_references(context, connection, node, *arguments)
                                         : show_tree(context, connection, node, *arguments);
    });
}

} // namespace busbar::tool
