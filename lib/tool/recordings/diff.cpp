#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/harness/text.hpp>

#include "recording_file.hpp"
#include "tool/commands/commands.hpp"
#include "tool/connection/context.hpp"
#include "tool/nodes/names.hpp"
#include "tool/nodes/remote_nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

/// A node in words that mean the same at another server.
struct KnownNode {
    NodeClass node_class{NodeClass::Unspecified};
    std::map<AttributeId, Variant> attributes;
    /// "HasComponent of" or to which node, in both directions.
    std::set<std::string> references;
};

/// The nodes of a server.
struct KnownServer {
    std::map<std::string, KnownNode> nodes;
    bool is_complete{true};
};

constexpr std::array compared = {AttributeId::BrowseName,  AttributeId::DisplayName,
                                 AttributeId::Description, AttributeId::DataType,
                                 AttributeId::ValueRank,   AttributeId::ArrayDimensions,
                                 AttributeId::AccessLevel, AttributeId::MinimumSamplingInterval,
                                 AttributeId::Historizing, AttributeId::EventNotifier,
                                 AttributeId::Executable,  AttributeId::IsAbstract,
                                 AttributeId::Symmetric,   AttributeId::InverseName,
                                 AttributeId::Value};

/// Reads one server.
class ServerReader {
public:
    ServerReader(Context& context, const std::string& place, bool with_values)
    {
        std::vector<std::string> places{place};
        take_url(places, context.options);
        Connection connection{context};
        namespaces_ = connection.client().server().namespaces;
        const RemoteNodes remote =
            read_remote_nodes(context, connection, [&](const NodeId&) { return with_values; });
        server_.is_complete = remote.is_complete;
        for (const RemoteNode& node : remote.nodes) {
            add(node);
        }
    }
    [[nodiscard]] KnownServer take() { return std::move(server_); }

private:
    /// "nsu=URI;s=Level".
    [[nodiscard]] std::string key_of(const NodeId& id) const
    {
        const std::uint16_t index = id.namespace_index();
        std::string text = to_string(id);
        if (index < 2 || index >= namespaces_.size()) {
            return text;
        }
        return "nsu=" + namespaces_[index] + ";" + text.substr(text.find(';') + 1);
    }
    /// Ids and names of namespaces are told by their URIs.
    [[nodiscard]] Variant portable(const Variant& value) const
    {
        if (const NodeId* const id = value.get_if<NodeId>()) {
            return Variant{String{key_of(*id)}};
        }
        if (const QualifiedName* const name = value.get_if<QualifiedName>()) {
            const std::uint16_t index = name->namespace_index;
            if (index >= 2 && index < namespaces_.size()) {
                return Variant{String{namespaces_[index] + ":" + std::string{name->name.view()}}};
            }
        }
        return value;
    }
    void add(const RemoteNode& node)
    {
        KnownNode& known = server_.nodes[key_of(node.id)];
        known.node_class = node.node_class;
        for (const auto& [attribute, value] : node.attributes) {
            known.attributes.emplace(attribute, portable(value));
        }
        for (const ReferenceDescription& reference : node.references) {
            if (reference.node_id.is_local()) {
                known.references.insert(key_of(reference.reference_type_id) +
                                        (reference.is_forward ? " to " : " of ") +
                                        key_of(reference.node_id.node_id));
            }
        }
    }

    std::vector<std::string> namespaces_;
    KnownServer server_;
};

/// The number in a value; nothing if it is none, or an array.
std::optional<double> real_of(const Variant& value)
{
    if (const double* const number = value.get_if<double>()) {
        return *number;
    }
    if (const float* const number = value.get_if<float>()) {
        return *number;
    }
    const std::string text = harness::text_of(value);
    const std::size_t begin = text.find(' ');
    const bool is_integer = text.find("Int") != std::string::npos || text.starts_with("Byte ") ||
                            text.starts_with("SByte ");
    double number = 0;
    if (!is_integer || begin == std::string::npos) {
        return std::nullopt;
    }
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + begin + 1, end, number);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

/// Types of values are told; those of other attributes are known.
std::string attribute_text(AttributeId attribute, const Variant& value)
{
    const String* const text = value.get_if<String>();
    if (attribute != AttributeId::Value && text != nullptr) {
        return std::string{text->view()};
    }
    return harness::text_of(value);
}

class ServerComparison {
public:
    explicit ServerComparison(const harness::ComparisonOptions& options) : options_{options} {}

    [[nodiscard]] std::vector<Difference> compare(const KnownServer& first,
                                                  const KnownServer& second)
    {
        for (const auto& [key, node] : first.nodes) {
            const auto found = second.nodes.find(key);
            if (found == second.nodes.end()) {
                add(key, std::string{name(node.node_class)}, "");
            } else {
                compare(key, node, found->second);
                compare_references(key, node.references, found->second.references, first, second);
            }
        }
        for (const auto& [key, node] : second.nodes) {
            if (!first.nodes.contains(key)) {
                add(key, "", std::string{name(node.node_class)});
            }
        }
        if (left_out_ != 0) {
            differences_.push_back({std::to_string(left_out_) + " more", "", ""});
        }
        return std::move(differences_);
    }

private:
    void compare(const std::string& key, const KnownNode& first, const KnownNode& second)
    {
        if (first.node_class != second.node_class) {
            add(key + " NodeClass", std::string{name(first.node_class)},
                std::string{name(second.node_class)});
            return;
        }
        for (const AttributeId attribute : compared) {
            const auto a = first.attributes.find(attribute);
            const auto b = second.attributes.find(attribute);
            const bool is_there = a != first.attributes.end();
            const bool is_here = b != second.attributes.end();
            const bool is_same =
                is_there == is_here && (!is_there || this->is_same(a->second, b->second));
            if (!is_same) {
                add(key + " " + std::string{name(attribute)},
                    is_there ? attribute_text(attribute, a->second) : "nothing",
                    is_here ? attribute_text(attribute, b->second) : "nothing");
            }
        }
    }
    [[nodiscard]] bool is_same(const Variant& first, const Variant& second) const
    {
        const bool are_times = first.type() == BuiltInType::DateTime &&
                               second.type() == BuiltInType::DateTime && !options_.with_times;
        if (first == second || are_times) {
            return true;
        }
        const auto a = real_of(first);
        const auto b = real_of(second);
        return a && b && first.type() == second.type() && std::fabs(*a - *b) <= options_.tolerance;
    }
    /// References to nodes that one server lacks are not told: the nodes are.
    void compare_references(const std::string& key, const std::set<std::string>& first,
                            const std::set<std::string>& second, const KnownServer& of_first,
                            const KnownServer& of_second)
    {
        const auto leads_out = [](const std::string& reference, const KnownServer& server) {
            const std::string target = reference.substr(reference.find(' ') + 4);
            const bool is_standard = !target.starts_with("ns");
            return !is_standard && !server.nodes.contains(target);
        };
        const std::string title = key + " reference ";
        for (const std::string& reference : first) {
            if (!second.contains(reference) && !leads_out(reference, of_second)) {
                add(title + reference, "there", "");
            }
        }
        for (const std::string& reference : second) {
            if (!first.contains(reference) && !leads_out(reference, of_first)) {
                add(title + reference, "", "there");
            }
        }
    }
    void add(const std::string& what, const std::string& first, const std::string& second)
    {
        if (differences_.size() < options_.max_lines) {
            differences_.push_back({safe(what), safe(first), safe(second)});
        } else {
            ++left_out_;
        }
    }

    harness::ComparisonOptions options_;
    std::vector<Difference> differences_;
    std::size_t left_out_{0};
};

/// Prints what differs between the nodes of two servers, except those of namespace 0 and those that
/// describe sessions; Failed if something does. Nodes are the same if their NodeIds are, by the
/// URIs of namespaces and not their indices; namespace 1, which is each server's own, is the same
/// one. Throws Failure. Partly if a server did not show all and nothing differs.
Exit diff_servers(Context& context, const std::string& first, const std::string& second,
                  bool with_values, const ComparisonArguments& arguments)
{
    // A profile of the first server is none of the second one's.
    const Options given = context.options;
    const KnownServer one = ServerReader{context, first, with_values}.take();
    context.options = given;
    const KnownServer other = ServerReader{context, second, with_values}.take();
    const auto differences = ServerComparison{arguments.options}.compare(one, other);
    std::vector<std::string> lines;
    for (const Difference& difference : differences) {
        const auto text = [](const std::string& side) { return side.empty() ? "nothing" : side; };
        lines.push_back(difference.what + ": " + text(difference.first) + " -> " +
                        text(difference.second));
    }
    write_differences_report(lines, first + " and " + second, arguments);
    const Exit exit = print_differences(context, differences, {"NODE", "FIRST", "SECOND", "-"});
    const bool is_complete = one.is_complete && other.is_complete;
    if (!is_complete) {
        context.err.line("busbar: some nodes could not be browsed");
    }
    return exit == Exit::Good && !is_complete ? Exit::Partly : exit;
}

struct DiffArguments {
    std::string before;
    std::string after;
    std::string keys;
    bool ignores_values{false};
    ComparisonArguments comparison;
};

bool is_server(const std::string& place)
{
    return is_url(place) || (place.size() > 1 && place.front() == '@');
}

Exit diff(Context& context, const DiffArguments& arguments)
{
    ComparisonArguments comparison = arguments.comparison;
    comparison.is_secret = !arguments.keys.empty();
    const std::string title = arguments.before + " and " + arguments.after;
    if (is_server(arguments.before) != is_server(arguments.after)) {
        throw Failure{Exit::Usage, "found a server and a recording; expected two of a kind"};
    }
    if (is_server(arguments.before)) {
        return diff_servers(context, arguments.before, arguments.after, !arguments.ignores_values,
                            comparison);
    }
    const auto before =
        harness::read_messages(read_recording_file(arguments.before, arguments.keys));
    const auto after = harness::read_messages(read_recording_file(arguments.after, arguments.keys));
    const bool is_first_readable =
        check_readable(context, arguments.before, before, arguments.keys);
    const bool is_readable =
        check_readable(context, arguments.after, after, arguments.keys) && is_first_readable;
    return exit_of_comparison(
        print_differences(context, harness::compare_messages(before, after, comparison.options),
                          title, comparison),
        is_readable);
}

} // namespace

void add_diff(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "diff", "Says what differs between two recordings, or two servers' nodes and values.");
    const auto arguments = std::make_shared<DiffArguments>();
    command->add_option("FIRST", arguments->before, "a recording, or a server's URL")->required();
    command->add_option("SECOND", arguments->after, "another one")->required();
    command->add_flag("--no-values", arguments->ignores_values, "of servers, compare nodes alone");
    add_keys_option(*command, arguments->keys);
    add_comparison_options(*command, arguments->comparison);
    when_chosen(*command, run, [arguments](Context& context) {
        unmark(arguments->before);
        unmark(arguments->after);
        return diff(context, *arguments);
    });
}

} // namespace busbar::tool
