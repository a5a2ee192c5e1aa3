
#include <algorithm>
#include <map>

#include <busbar/client/view.hpp>

#include "commands.hpp"
#include "tool/connection/context.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/variable_facts.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/value_type.hpp"

namespace busbar::tool {

namespace {

using command_line::CompletionPlace;
using Words = std::vector<std::string>;

/// The user waits for it.
constexpr double longest_wait = 3; // seconds

bool is_one_of(const std::string& word, std::initializer_list<const char*> words)
{
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// Reads the options on the line so far; ignores errors, which further typing may correct.
Options options_of_line(const CompletionPlace& place)
{
    Options options;
    Run ignored;
    CLI::App app{"", "busbar"};
    add_command_line(app, options, ignored);
    Words words{place.words.rbegin(), place.words.rend()};
    try {
        app.parse(words);
    } catch (const CLI::ParseError&) {
        // Mostly an argument is missing: the one that is typed.
    }
    options.given = given_options(app);
    complete_options(options);
    options.timeout = std::min(options.timeout, longest_wait);
    return options;
}

/// "Press 4" as an element of a path: what has a meaning there has a & before it.
std::string element_of(const QualifiedName& name, bool has_namespace)
{
    std::string text = has_namespace && name.namespace_index != 0
                           ? std::to_string(name.namespace_index) + ":"
                           : std::string{};
    for (const char character : name.name.view()) {
        text += std::string_view{"/.<>:#!&"}.find(character) == std::string_view::npos ? "" : "&";
        text += character;
    }
    return text;
}

Array<ReferenceDescription> children_of(Connection& connection, const NodeId& parent)
{
    using Results = std::vector<BrowseResult>;
    const auto results = connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::browse(connection.client(), {client::children_of(parent)}, std::move(done));
    });
    return results.front().references;
}

/// Paths below the folder that was typed. Namespaces are left out unless the user typed one, or two
/// names differ in nothing else.
Words nodes_at(Connection& connection, const std::string& word)
{
    const std::size_t slash = word.rfind('/');
    const std::string folder = word.substr(0, slash == std::string::npos ? 0 : slash + 1);
    const std::string last = word.substr(folder.size());
    if (!folder.starts_with('/') && !folder.starts_with('[')) {
        return {"/Objects/"};
    }
    const std::string path = folder.size() == 1 ? folder : folder.substr(0, folder.size() - 1);
    const auto children = children_of(connection, find_node(connection, path));
    std::map<std::string, int> plain;
    for (const ReferenceDescription& child : children) {
        ++plain[element_of(child.browse_name, false)];
    }
    const bool has_namespace =
        last.find(':') != std::string::npos ||
        (!last.empty() && last.find_first_not_of("0123456789") == std::string::npos);
    Words nodes;
    for (const ReferenceDescription& child : children) {
        const bool is_unique = plain[element_of(child.browse_name, false)] == 1;
        const bool is_folder = child.node_class == NodeClass::Object;
        const std::string node = folder +
                                 element_of(child.browse_name, has_namespace || !is_unique) +
                                 (is_folder ? "/" : "");
        if (safe(node) == node) { // a shell takes what it is given
            nodes.push_back(node);
        }
    }
    return nodes;
}

/// Returns texts that can be written to the node: names of an enumeration, true and false.
Words values_of(Connection& connection, const std::string& node)
{
    const auto nodes = find_nodes(connection, {node});
    const ValueFacts facts = facts_of(connection, nodes, FactsWanted::DataType).front();
    if (facts.data_type == NodeId{0, static_cast<std::uint32_t>(BuiltInType::Boolean)}) {
        return {"true", "false"};
    }
    Words names;
    const binary::DynamicType* const type = find_type(connection.types().types(), facts.data_type);
    if (type != nullptr) {
        for (const auto& value : type->values) {
            names.push_back(safe(value.name));
        }
    }
    return names;
}

Words methods_of(Connection& connection, const std::string& object)
{
    Words names;
    for (const ReferenceDescription& child :
         children_of(connection, find_node(connection, object))) {
        if (child.node_class == NodeClass::Method) {
            names.push_back(safe(child.browse_name.name.view()));
        }
    }
    return names;
}

Words ask(const CompletionPlace& place)
{
    Context context;
    context.options = options_of_line(place);
    Words arguments = place.arguments;
    take_url(arguments, context.options);
    const std::string command = place.command->get_name();
    Connection connection{context};
    if (command == "write" && arguments.size() % 2 == 1) {
        return values_of(connection, arguments.back());
    }
    if (command == "call" && !arguments.empty()) {
        return arguments.size() == 1 ? methods_of(connection, arguments.front()) : Words{};
    }
    return nodes_at(connection, place.word);
}

Words profiles_of(const std::string& prefix)
{
    Words names = profile_names();
    for (std::string& name : names) {
        name.insert(0, prefix);
    }
    return names;
}

bool takes_nodes(const CompletionPlace& place)
{
    const bool is_top = place.command->get_parent() != nullptr &&
                        place.command->get_parent()->get_parent() == nullptr;
    return is_top && is_one_of(place.command->get_name(),
                               {"browse", "read", "write", "subscribe", "watch", "call", "events"});
}

} // namespace

std::vector<std::string> complete(const command_line::CompletionPlace& place)
{
    if (place.option != nullptr) {
        const std::string name =
            place.option->get_lnames().empty() ? std::string{} : place.option->get_lnames().front();
        if (name == "profile") {
            return profiles_of("");
        }
        if (name == "attribute") {
            return attribute_names();
        }
        if (name != "below") {
            return {};
        }
    }
    if (place.word.starts_with('@')) {
        return profiles_of("@");
    }
    if (!takes_nodes(place)) {
        return place.command->get_name() == "completion" ? Words{"bash", "zsh", "fish"} : Words{};
    }
    try {
        return ask(place);
    } catch (const Failure&) {
        return {};
    } catch (const Interrupted&) {
        return {};
    }
}

} // namespace busbar::tool
