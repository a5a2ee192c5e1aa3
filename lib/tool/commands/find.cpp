#include <algorithm>
#include <memory>
#include <unordered_map>

#include <busbar/client/view.hpp>

#include "commands.hpp"
#include "core/ascii_case.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/node_feed.hpp"
#include "tool/nodes/variable_facts.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

using client::BrowsedTree;
using client::TreeNode;

struct FindArguments {
    std::vector<std::string> words; // [URL] and the text
    std::string below{"/Objects"};
    std::size_t limit{100};
};

/// A node with the name of its type: the DataType of a Variable, the TypeDefinition of an Object.
struct Candidate {
    std::string path;
    const ReferenceDescription* reference;
    std::string type{};
    std::string data_type{};
};

std::string lower(std::string_view text)
{
    std::string result{text};
    std::transform(result.begin(), result.end(), result.begin(), busbar::detail::to_ascii_lower);
    return result;
}

/// "*" stands for any text; without one the pattern may stand anywhere.
bool matches(std::string_view text, std::string_view pattern)
{
    const std::size_t star = pattern.find('*');
    if (star == std::string_view::npos) {
        return text == pattern;
    }
    if (!text.starts_with(pattern.substr(0, star))) {
        return false;
    }
    const std::string_view rest = pattern.substr(star + 1);
    for (std::size_t from = star; from <= text.size(); ++from) {
        if (rest.find('*') == std::string_view::npos) {
            return text.size() >= star + rest.size() && text.ends_with(rest);
        }
        if (matches(text.substr(from), rest)) {
            return true;
        }
    }
    return false;
}

class Pattern {
public:
    explicit Pattern(const std::string& text)
        : text_{lower(text)}, has_star_{text.find('*') != std::string::npos}
    {
    }
    [[nodiscard]] bool fits(std::string_view name) const
    {
        const std::string text = lower(name);
        return has_star_ ? matches(text, text_) : text.find(text_) != std::string::npos;
    }
    /// A type is named in full: "Double" does not find ContinuousDouble.
    [[nodiscard]] bool is_type(std::string_view name) const
    {
        const std::string text = lower(name);
        return !text.empty() && (has_star_ ? matches(text, text_) : text == text_);
    }

private:
    std::string text_;
    bool has_star_;
};

/// The names of the TypeDefinitions, each asked for once.
std::unordered_map<NodeId, std::string> definitions_in(Connection& connection,
                                                       const BrowsedTree& tree)
{
    std::unordered_map<NodeId, std::string> names;
    for (const TreeNode& node : tree.nodes) {
        names.try_emplace(node.reference.type_definition.node_id);
    }
    std::vector<NodeId> definitions;
    definitions.reserve(names.size());
    for (const auto& [definition, name] : names) {
        definitions.push_back(definition);
    }
    const auto found = type_names(connection, definitions);
    for (std::size_t i = 0; i < definitions.size(); ++i) {
        names[definitions[i]] = found[i];
    }
    return names;
}

/// All nodes of the tree, with the names of their types.
std::vector<Candidate> candidates_in(Connection& connection, const BrowsedTree& tree,
                                     const NodeId& root, const std::string& name)
{
    std::vector<Candidate> candidates;
    std::vector<NamedNode> variables;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const TreeNode& node = tree.nodes[i];
        const ReferenceDescription& reference = node.reference;
        const bool is_variable =
            reference.node_class == NodeClass::Variable && reference.node_id.is_local();
        const bool is_root = node.parent == TreeNode::no_parent;
        candidates.push_back({is_root ? name : path_below(root, name, tree, i), &reference});
        variables.push_back({"", is_variable ? Result<NodeId>{reference.node_id.node_id}
                                             : Result<NodeId>{fail(status::Bad_NotFound)}});
    }
    const auto facts = facts_of(connection, variables, FactsWanted::TypeName);
    const auto definitions = definitions_in(connection, tree);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i].type = definitions.at(tree.nodes[i].reference.type_definition.node_id);
        candidates[i].data_type = facts[i].type_name;
    }
    return candidates;
}

bool is_found(const Candidate& candidate, const Pattern& pattern)
{
    const ReferenceDescription& reference = *candidate.reference;
    return pattern.fits(reference.browse_name.name.view()) ||
           pattern.fits(reference.display_name.text.view()) || pattern.is_type(candidate.type) ||
           pattern.is_type(candidate.data_type);
}

void print(Context& context, const std::vector<Candidate>& found, std::size_t limit)
{
    JsonLine json;
    json.open_array();
    Table table{{{"NODE", 24, false, true}, {"CLASS"}, {"TYPE", 12}, {"NODE ID", 12}}};
    for (std::size_t i = 0; i < std::min(limit, found.size()); ++i) {
        const ReferenceDescription& reference = *found[i].reference;
        const std::string& type = found[i].data_type.empty() ? found[i].type : found[i].data_type;
        const std::string id = to_string(reference.node_id);
        json.open_object().member("node", found[i].path).member("nodeId", id);
        json.member("nodeClass", name(reference.node_class)).member("type", type).close_object();
        table.add({{safe(found[i].path)},
                   {std::string{name(reference.node_class)}, Style::Dim},
                   {type},
                   {safe(id)}});
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
        return;
    }
    table.print(context.out);
    if (found.size() > limit) {
        context.err.line("busbar: " + std::to_string(found.size() - limit) +
                         " more are not shown: --limit 0 shows all");
    }
}

Exit find(Context& context, Connection& connection, const FindArguments& arguments)
{
    const NodeId root = find_node(connection, arguments.below);
    const auto tree = connection.wait_for<BrowsedTree>([&](std::function<void(BrowsedTree)> done) {
        client::browse_tree(connection.client(), {root}, client::children_of(root),
                            std::move(done));
    });
    if (tree.nodes.front().status.is_bad()) {
        throw Failure{tree.nodes.front().status, arguments.below};
    }
    const Pattern pattern{arguments.words.front()};
    std::vector<Candidate> found;
    for (Candidate& candidate : candidates_in(connection, tree, root, arguments.below)) {
        if (candidate.path != arguments.below && is_found(candidate, pattern)) {
            found.push_back(std::move(candidate));
        }
    }
    if (!tree.is_complete) {
        context.warn("incomplete", "the server has more nodes than could be browsed");
    }
    if (found.empty()) {
        throw Failure{Exit::Failed,
                      arguments.words.front() + ": nothing below " + arguments.below +
                          " has this name or type",
                      "part of a name is enough, * stands for any text; --below / looks at types, "
                      "too"};
    }
    print(context, found, arguments.limit == 0 ? SIZE_MAX : arguments.limit);
    return Exit::Good;
}

} // namespace

void add_find(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("find", "Finds nodes by their name or their type.");
    const auto arguments = std::make_shared<FindArguments>();
    command
        ->add_option(
            "TEXT", arguments->words,
            "server (optional), then part of a name, or the name of a type; * for any text")
        ->required();
    command->add_option("--below", arguments->below, "where to look")
        ->type_name("NODE")
        ->capture_default_str();
    command->add_option("--limit", arguments->limit, "nodes to show; 0 for all")
        ->type_name("N")
        ->capture_default_str();
    command->footer("A type is that of an Object or the DataType of a Variable: `busbar find\n"
                    "MachineMode`. Large and small letters are the same.");
    when_chosen(*command, run, [arguments](Context& context) {
        take_url(arguments->words, context.options, 1);
        if (arguments->words.size() != 1 || arguments->words.front().empty()) {
            throw Failure{Exit::Usage, "expected one text to look for", "busbar find [URL] TEXT"};
        }
        check_addresses({arguments->below});
        Connection connection{context};
        return find(context, connection, *arguments);
    });
}

} // namespace busbar::tool
