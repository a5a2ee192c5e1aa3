#include "nodes.hpp"

#include <busbar/client/attributes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::cli {

namespace {

std::vector<DataValue> read(Connection& connection, std::vector<ReadValueId> items)
{
    using Values = std::vector<DataValue>;
    return connection.wait_for<Values>([&](std::function<void(Values)> done) {
        client::read(connection.client(), std::move(items), std::move(done));
    });
}

} // namespace

client::NodeAddress parse_address(const std::string& text)
{
    if (text == "/") {
        return NodeId{0, id::RootFolder}; // where paths begin
    }
    auto address = client::NodeAddress::parse(text);
    if (!address) {
        Failure failure{address.error(), text};
        failure.exit = Exit::Usage;
        throw failure;
    }
    return *std::move(address);
}

void check_addresses(const std::vector<std::string>& texts)
{
    for (const std::string& text : texts) {
        static_cast<void>(parse_address(text));
    }
}

std::vector<NamedNode> find_nodes(Connection& connection, const std::vector<std::string>& texts)
{
    std::vector<client::NodeAddress> addresses;
    addresses.reserve(texts.size());
    for (const std::string& text : texts) {
        addresses.push_back(parse_address(text));
    }
    using Ids = std::vector<Result<NodeId>>;
    const Ids ids = connection.wait_for<Ids>([&](std::function<void(Ids)> done) {
        client::resolve(connection.client(), std::move(addresses), std::move(done));
    });
    std::vector<NamedNode> nodes;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        nodes.push_back({texts[i], ids[i]});
    }
    return nodes;
}

NodeId find_node(Connection& connection, const std::string& text)
{
    return connection.value(find_nodes(connection, {text}).front().id, text);
}

std::vector<DataValue> read_attributes(Connection& connection, const NodeId& node,
                                       const std::vector<AttributeId>& attributes)
{
    std::vector<ReadValueId> items;
    items.reserve(attributes.size());
    for (const AttributeId attribute : attributes) {
        items.push_back(client::attribute_of(node, attribute));
    }
    return read(connection, std::move(items));
}

std::vector<DataValue> read_nodes(Connection& connection, const std::vector<NamedNode>& nodes,
                                  AttributeId attribute, std::string_view index_range)
{
    std::vector<ReadValueId> items;
    for (const NamedNode& node : nodes) {
        if (node.id) {
            items.push_back(client::attribute_of(*node.id, attribute, index_range));
        }
    }
    std::vector<DataValue> values;
    if (!items.empty()) {
        values = read(connection, std::move(items));
    }
    std::vector<DataValue> result(nodes.size());
    auto next = values.begin();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].id) {
            result[i] = std::move(*next++);
        } else {
            result[i].status = nodes[i].id.error();
        }
    }
    return result;
}

} // namespace busbar::cli
