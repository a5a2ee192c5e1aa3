#include "remote_nodes.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include <busbar/client/attributes.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::tool {

namespace {

/// A line that is written over itself.
class Progress {
public:
    explicit Progress(Context& context)
        : err_{&context.err}, is_shown_{context.err.is_terminal() && !context.options.is_json}
    {
    }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress() { say(""); }

    void say(const std::string& text)
    {
        if (is_shown_) {
            err_->write("\r\x1b[K" + text);
        }
    }

private:
    Output* err_;
    bool is_shown_;
};

std::vector<NodeId> find_from_root(Connection& connection, bool& is_complete)
{
    const NodeId root{0, id::RootFolder};
    client::TreeLimits limits;
    limits.max_nodes = 1'000'000;
    const auto tree = connection.wait_for<client::BrowsedTree>(
        [&](std::function<void(client::BrowsedTree)> done) {
            client::browse_tree(connection.client(), {root}, client::children_of(root),
                                std::move(done), limits);
        });
    is_complete = is_complete && tree.is_complete;
    std::vector<NodeId> found;
    for (const client::TreeNode& node : tree.nodes) {
        const ExpandedNodeId& id = node.reference.node_id;
        if (id.is_local() && id.node_id.namespace_index() != 0) {
            found.push_back(id.node_id);
        }
    }
    return found;
}

std::vector<BrowseResult> browse_all(Connection& connection, const std::vector<NodeId>& nodes)
{
    std::vector<BrowseDescription> descriptions;
    for (const NodeId& node : nodes) {
        BrowseDescription& description = descriptions.emplace_back(client::children_of(node));
        description.browse_direction = BrowseDirection::Both;
        description.reference_type_id = NodeId{0, id::References};
    }
    using Results = std::vector<BrowseResult>;
    return connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::browse(connection.client(), std::move(descriptions), std::move(done));
    });
}

/// The nodes with their references, and those that only such a reference leads to.
std::vector<RemoteNode> follow_references(Connection& connection, std::vector<NodeId> pending,
                                          bool& is_complete)
{
    std::unordered_set<NodeId> known{pending.begin(), pending.end()};
    std::vector<RemoteNode> nodes;
    while (!pending.empty()) {
        auto results = browse_all(connection, pending);
        std::vector<NodeId> next;
        for (std::size_t i = 0; i < pending.size(); ++i) {
            is_complete = is_complete && results[i].status_code.is_good();
            for (const ReferenceDescription& reference : results[i].references) {
                const NodeId& target = reference.node_id.node_id;
                if (reference.node_id.is_local() && target.namespace_index() != 0 &&
                    known.insert(target).second) {
                    next.push_back(target);
                }
            }
            RemoteNode& node = nodes.emplace_back();
            node.id = std::move(pending[i]);
            node.references = std::move(results[i].references);
        }
        pending = std::move(next);
    }
    return nodes;
}

/// The nodes of sessions and Subscriptions are below these.
constexpr std::uint32_t diagnostics[] = {
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary,
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray,
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray,
    id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray};

constexpr AttributeId common[] = {AttributeId::NodeClass, AttributeId::BrowseName,
                                  AttributeId::DisplayName, AttributeId::Description};

/// The attributes that the AddressSpace stores for each class (Part 3, 5).
std::vector<AttributeId> attributes_of(NodeClass node_class, bool with_value)
{
    std::vector<AttributeId> ids;
    switch (node_class) {
    case NodeClass::Object:
    case NodeClass::View:
        ids = {AttributeId::EventNotifier, AttributeId::ContainsNoLoops};
        break;
    case NodeClass::Variable:
        ids = {AttributeId::DataType,
               AttributeId::ValueRank,
               AttributeId::ArrayDimensions,
               AttributeId::AccessLevel,
               AttributeId::MinimumSamplingInterval,
               AttributeId::Historizing};
        break;
    case NodeClass::VariableType:
        ids = {AttributeId::DataType, AttributeId::ValueRank, AttributeId::ArrayDimensions,
               AttributeId::IsAbstract};
        break;
    case NodeClass::Method:
        ids = {AttributeId::Executable};
        break;
    case NodeClass::ReferenceType:
        ids = {AttributeId::IsAbstract, AttributeId::Symmetric, AttributeId::InverseName};
        break;
    case NodeClass::DataType:
        ids = {AttributeId::IsAbstract, AttributeId::DataTypeDefinition};
        break;
    default:
        ids = {AttributeId::IsAbstract};
        break;
    }
    const bool has_value =
        node_class == NodeClass::Variable || node_class == NodeClass::VariableType;
    if (has_value && with_value) {
        ids.push_back(AttributeId::Value);
    }
    return ids;
}

/// The attributes to read, with the nodes that they belong to.
struct Reading {
    std::vector<ReadValueId> items;
    std::vector<std::size_t> owners;

    void add(const std::vector<RemoteNode>& nodes, std::size_t node, AttributeId attribute)
    {
        items.push_back(client::attribute_of(nodes[node].id, attribute));
        owners.push_back(node);
    }
};

void read_into(Connection& connection, std::vector<RemoteNode>& nodes, Reading reading)
{
    std::vector<AttributeId> attributes;
    for (const ReadValueId& item : reading.items) {
        attributes.push_back(static_cast<AttributeId>(item.attribute_id));
    }
    using Values = std::vector<DataValue>;
    Values values = connection.wait_for<Values>([&](std::function<void(Values)> done) {
        client::read(connection.client(), std::move(reading.items), std::move(done));
    });
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!values[i].status.is_bad()) {
            nodes[reading.owners[i]].attributes[attributes[i]] = std::move(values[i].value);
        }
    }
}

} // namespace

void leave_out_diagnostics(std::vector<RemoteNode>& nodes)
{
    std::unordered_map<NodeId, const RemoteNode*> by_id;
    std::vector<NodeId> pending;
    const auto is_component = [](const ReferenceDescription& reference) {
        return reference.reference_type_id.is(id::HasComponent) ||
               reference.reference_type_id.is(id::HasProperty);
    };
    for (const RemoteNode& node : nodes) {
        by_id.emplace(node.id, &node);
        for (const ReferenceDescription& reference : node.references) {
            const NodeId& owner = reference.node_id.node_id;
            if (!reference.is_forward && is_component(reference) &&
                std::any_of(std::begin(diagnostics), std::end(diagnostics),
                            [&](std::uint32_t known) { return owner.is(known); })) {
                pending.push_back(node.id);
            }
        }
    }
    std::unordered_set<NodeId> left_out{pending.begin(), pending.end()};
    while (!pending.empty()) {
        const auto found = by_id.find(pending.back());
        pending.pop_back();
        if (found == by_id.end()) {
            continue;
        }
        for (const ReferenceDescription& reference : found->second->references) {
            if (reference.is_forward && is_component(reference) &&
                left_out.insert(reference.node_id.node_id).second) {
                pending.push_back(reference.node_id.node_id);
            }
        }
    }
    std::erase_if(nodes, [&](const RemoteNode& node) { return left_out.contains(node.id); });
}

void adopt_orphans(std::vector<RemoteNode>& nodes)
{
    std::unordered_map<NodeId, std::vector<ReferenceDescription>> orphans;
    const auto is_inverse = [](const ReferenceDescription& one) { return !one.is_forward; };
    for (const RemoteNode& node : nodes) {
        if (std::none_of(node.references.begin(), node.references.end(), is_inverse)) {
            orphans.try_emplace(node.id);
        }
    }
    for (const RemoteNode& node : nodes) {
        for (const ReferenceDescription& reference : node.references) {
            const auto orphan = orphans.find(reference.node_id.node_id);
            if (reference.is_forward && reference.node_id.is_local() && orphan != orphans.end()) {
                ReferenceDescription& back = orphan->second.emplace_back();
                back.reference_type_id = reference.reference_type_id;
                back.node_id = ExpandedNodeId{node.id};
            }
        }
    }
    for (RemoteNode& node : nodes) {
        const auto orphan = orphans.find(node.id);
        for (std::size_t i = 0; orphan != orphans.end() && i < orphan->second.size(); ++i) {
            node.references.push_back(orphan->second[i]);
        }
    }
}

RemoteNodes read_remote_nodes(Context& context, Connection& connection,
                              FunctionRef<bool(const NodeId&)> has_value)
{
    Progress progress{context};
    progress.say("looking for nodes ...");
    RemoteNodes remote;
    std::vector<RemoteNode>& nodes = remote.nodes;
    nodes = follow_references(connection, find_from_root(connection, remote.is_complete),
                              remote.is_complete);
    leave_out_diagnostics(nodes);
    adopt_orphans(nodes);
    progress.say("reading " + std::to_string(nodes.size()) + " nodes ...");
    Reading first;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const AttributeId attribute : common) {
            first.add(nodes, i, attribute);
        }
    }
    read_into(connection, nodes, std::move(first));
    Reading second;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        nodes[i].node_class =
            static_cast<NodeClass>(nodes[i].get<std::int32_t>(AttributeId::NodeClass));
        const bool with_value = has_value(nodes[i].id);
        for (const AttributeId attribute : attributes_of(nodes[i].node_class, with_value)) {
            second.add(nodes, i, attribute);
        }
    }
    read_into(connection, nodes, std::move(second));
    return remote;
}

} // namespace busbar::tool
