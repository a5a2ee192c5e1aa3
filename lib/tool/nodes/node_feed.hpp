#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/client/node_address.hpp>
#include <busbar/client/view.hpp>

#include "tool/stream/stream.hpp"

namespace busbar::tool {

/// The settings of subscriptions for values.
struct FeedSettings {
    double interval{500}; // milliseconds
    double sampling{-1};
    std::uint32_t queue_size{10};
};
void add_feed_options(CLI::App& command, FeedSettings& settings);

/// A node as the user knows it, and where it is found.
struct FeedNode {
    std::string text;
    client::NodeAddress address;
};
/// Their texts.
[[nodiscard]] std::vector<std::string> texts_of(const std::vector<FeedNode>& nodes);
/// Throws Failure for a text that is not an address.
[[nodiscard]] std::vector<FeedNode> parse_feed(const std::vector<std::string>& texts);

/// Called in run() of the Stream, with the index of the node.
struct FeedHandlers {
    std::function<void(std::size_t, const DataValue&)> on_value;
    /// Called with the status of a monitored item.
    std::function<void(std::size_t, StatusCode)> on_status;
};

/// A Subscription to values of nodes.
class NodeFeed {
public:
    /// Throws Failure.
    NodeFeed(Connection& connection, Stream& stream, const FeedSettings& settings,
             std::vector<FeedNode> nodes, FeedHandlers handlers);
    NodeFeed(const NodeFeed&) = delete;
    NodeFeed& operator=(const NodeFeed&) = delete;
    /// Closes the connection, so that no handler is called later.
    ~NodeFeed() { connection_->close(); }

    [[nodiscard]] const std::vector<FeedNode>& nodes() const { return nodes_; }
    /// Adds an item to the Subscription, whose events and status are delivered in run(), too.
    void add_events(client::ItemSettings item, std::function<void(const Array<Variant>&)> on_event,
                    std::function<void(StatusCode)> on_status);

private:
    void subscribe(const FeedSettings& settings);
    void take_status(client::ItemHandle item, StatusCode status);

    Connection* connection_;
    Stream* stream_;
    std::vector<FeedNode> nodes_;
    FeedHandlers handlers_;
    client::SubscriptionHandle subscription_{0};
    std::unordered_map<client::ItemHandle, std::size_t> node_of_;
    std::function<void(const Array<Variant>&)> on_event_;
    std::function<void(StatusCode)> on_event_status_;
};

struct VariableBelow {
    /// The address is its NodeId, the text a path.
    FeedNode node;
    /// The path from the node that it was looked for below of.
    std::string name;
};

struct VariablesBelow {
    std::vector<VariableBelow> variables;
    /// Number of Variables beyond the wanted ones.
    std::size_t left_out{0};
    /// False if a failure, or a limit, kept something out.
    bool is_complete{true};
};

/// The Variables below the nodes that the user names, in the order of the levels, without
/// Properties; if none is named, those below Objects that are not in namespace 0. At most `limit`.
/// Throws Failure.
[[nodiscard]] VariablesBelow
variables_below(Connection& connection, const std::vector<std::string>& nodes, std::size_t limit);

/// "/Objects/2:Machine/2:Speed": the address of a node of a tree that was browsed from one node,
/// `root`, which the user calls `name`.
[[nodiscard]] std::string path_below(const NodeId& root, const std::string& name,
                                     const client::BrowsedTree& tree, std::size_t index);

} // namespace busbar::tool
