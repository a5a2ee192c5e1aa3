#include "node_feed.hpp"

#include <CLI/CLI.hpp>

#include <busbar/binary/relative_path.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "nodes.hpp"

namespace busbar::tool {

namespace {

using client::BrowsedTree;
using client::TreeNode;

constexpr std::string_view objects = "/Objects";

/// A node to start browsing from.
struct Root {
    NodeId id;
    client::NodeAddress address;
};

BrowsedTree browse(Connection& connection, const std::vector<NodeId>& roots, std::size_t max_depth)
{
    client::TreeLimits limits;
    limits.max_depth = max_depth;
    return connection.wait_for<BrowsedTree>([&](std::function<void(BrowsedTree)> done) {
        client::browse_tree(connection.client(), roots, client::children_of({}), std::move(done),
                            limits);
    });
}

/// "/2:Machine/2:Speed": how a node was found below its root.
std::string path_to(const BrowsedTree& tree, std::size_t index)
{
    const TreeNode& node = tree.nodes[index];
    std::vector<RelativePathElement> up;
    for (; tree.nodes[index].parent != TreeNode::no_parent; index = tree.nodes[index].parent) {
        RelativePathElement& element = up.emplace_back();
        element.reference_type_id = NodeId{0, id::HierarchicalReferences};
        element.include_subtypes = true;
        element.target_name = tree.nodes[index].reference.browse_name;
    }
    RelativePath path;
    for (auto element = up.rbegin(); element != up.rend(); ++element) {
        path.elements.push_back(std::move(*element));
    }
    const auto text = binary::to_text(path, [](const NodeId&) { return QualifiedName{}; });
    return text ? *text : "/" + to_string(node.reference.node_id);
}

std::size_t root_of(const BrowsedTree& tree, std::size_t index)
{
    while (tree.nodes[index].parent != TreeNode::no_parent) {
        index = tree.nodes[index].parent;
    }
    return index;
}

std::string text_below(const Root& root, const std::string& path)
{
    if (root.address.is_path()) {
        return root.address.text() + path;
    }
    const auto address = client::NodeAddress::path(path, root.id);
    return address ? address->text() : path;
}

bool is_wanted(const TreeNode& node, bool with_namespace_0)
{
    const ReferenceDescription& reference = node.reference;
    const bool is_own = reference.node_id.server_index == 0 &&
                        reference.reference_type_id != NodeId{0, id::HasProperty};
    return reference.node_class == NodeClass::Variable && is_own &&
           (with_namespace_0 || reference.node_id.node_id.namespace_index() != 0);
}

/// Lists the server's own nodes below Objects, because namespace 0 has thousands of nodes there.
std::vector<Root> own_objects(Connection& connection)
{
    std::vector<Root> roots;
    const BrowsedTree tree = browse(connection, {NodeId{0, id::ObjectsFolder}}, 1);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const NodeId& id = tree.nodes[i].reference.node_id.node_id;
        if (tree.nodes[i].parent != TreeNode::no_parent && id.namespace_index() != 0) {
            const auto address = client::NodeAddress::path(std::string{objects} + path_to(tree, i));
            roots.push_back({id, address ? *address : client::NodeAddress{id}});
        }
    }
    return roots;
}

std::vector<Root> named_roots(Connection& connection, const std::vector<std::string>& nodes)
{
    std::vector<Root> roots;
    for (const NamedNode& node : find_nodes(connection, nodes)) {
        roots.push_back({id_of(connection, node), parse_address(node.text)});
    }
    return roots;
}

} // namespace

void add_feed_options(CLI::App& command, FeedSettings& settings)
{
    command.add_option("-i,--interval", settings.interval, "publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command.add_option("--sampling", settings.sampling, "-1 for the publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command.add_option("--queue", settings.queue_size, "values kept between two publishings")
        ->type_name("N")
        ->capture_default_str();
}

std::vector<FeedNode> parse_feed(const std::vector<std::string>& texts)
{
    std::vector<FeedNode> nodes;
    nodes.reserve(texts.size());
    for (const std::string& text : texts) {
        nodes.push_back({text, parse_address(text)});
    }
    return nodes;
}

std::vector<std::string> texts_of(const std::vector<FeedNode>& nodes)
{
    std::vector<std::string> texts;
    texts.reserve(nodes.size());
    for (const FeedNode& node : nodes) {
        texts.push_back(node.address.text());
    }
    return texts;
}

NodeFeed::NodeFeed(Connection& connection, Stream& stream, const FeedSettings& settings,
                   std::vector<FeedNode> nodes, FeedHandlers handlers)
    : connection_{&connection}, stream_{&stream}, nodes_{std::move(nodes)}, handlers_{
                                                                                std::move(handlers)}
{
    subscribe(settings);
}

void NodeFeed::subscribe(const FeedSettings& settings)
{
    client::SubscriptionSettings wanted;
    wanted.publishing_interval = decltype(wanted.publishing_interval){settings.interval};
    auto handlers = stream_->handlers();
    handlers.on_data = [this](std::span<const client::DataChange> changes) {
        for (const client::DataChange& change : changes) {
            stream_->push(
                [this, change] { handlers_.on_value(node_of_.at(change.item), change.value); });
        }
    };
    handlers.on_events = [this](std::span<const client::EventArrived> events) {
        for (const client::EventArrived& event : events) {
            stream_->push([this, fields = event.fields] { on_event_(fields); });
        }
    };
    handlers.on_item = [this](client::ItemHandle item, const client::ItemStatus& status) {
        stream_->push([this, item, code = status.status] { take_status(item, code); });
    };
    auto& subscriptions = connection_->client().subscriptions();
    subscription_ =
        connection_->value(subscriptions.create(wanted, std::move(handlers)), "the subscription");
    std::vector<client::ItemSettings> items;
    for (const FeedNode& node : nodes_) {
        client::ItemSettings& item = items.emplace_back();
        item.node = node.address;
        item.sampling_interval = decltype(item.sampling_interval){settings.sampling};
        item.queue_size = settings.queue_size;
    }
    const auto handles = connection_->value(
        subscriptions.add_items(subscription_, std::move(items)), "the monitored items");
    for (std::size_t i = 0; i < handles.size(); ++i) {
        node_of_.emplace(handles[i], i);
    }
}

void NodeFeed::add_events(client::ItemSettings item,
                          std::function<void(const Array<Variant>&)> on_event,
                          std::function<void(StatusCode)> on_status)
{
    on_event_ = std::move(on_event);
    on_event_status_ = std::move(on_status);
    static_cast<void>(connection_->value(
        connection_->client().subscriptions().add_items(subscription_, {std::move(item)}),
        "the monitored item of events"));
}

void NodeFeed::take_status(client::ItemHandle item, StatusCode status)
{
    if (const auto found = node_of_.find(item); found != node_of_.end()) {
        handlers_.on_status(found->second, status);
    } else {
        on_event_status_(status);
    }
}

std::string path_below(const NodeId& root, const std::string& name, const BrowsedTree& tree,
                       std::size_t index)
{
    const std::string path = path_to(tree, index);
    return name == "/" ? path : text_below({root, parse_address(name)}, path);
}

VariablesBelow variables_below(Connection& connection, const std::vector<std::string>& nodes,
                               std::size_t limit)
{
    const bool is_default = nodes.empty();
    const auto roots = is_default ? own_objects(connection) : named_roots(connection, nodes);
    std::vector<NodeId> ids;
    for (const Root& root : roots) {
        ids.push_back(root.id);
    }
    VariablesBelow found;
    if (ids.empty()) {
        return found;
    }
    const BrowsedTree tree = browse(connection, ids, client::TreeLimits{}.max_depth);
    found.is_complete = tree.is_complete;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        if (tree.nodes[i].parent == TreeNode::no_parent && tree.nodes[i].status.is_bad()) {
            throw Failure{tree.nodes[i].status, roots[i].address.text()};
        }
        if (!is_wanted(tree.nodes[i], !is_default)) {
            continue;
        }
        if (found.variables.size() == limit) {
            ++found.left_out;
            continue;
        }
        const std::string path = path_to(tree, i);
        const std::string text = text_below(roots[root_of(tree, i)], path);
        const std::string short_text = is_default ? text.substr(objects.size() + 1) : text;
        found.variables.push_back({{text, tree.nodes[i].reference.node_id.node_id},
                                   roots.size() > 1 ? short_text : path.substr(1)});
    }
    return found;
}

} // namespace busbar::tool
