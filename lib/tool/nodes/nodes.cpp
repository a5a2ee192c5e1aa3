#include "nodes.hpp"

#include <utility>

#include <busbar/client/attributes.hpp>
#include <busbar/client/resolve_nodes.hpp>
#include <busbar/types/ids.hpp>

#include "tool/printing/display_text.hpp"

namespace busbar::tool {

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
        throw Failure{std::move(failure)};
    }
    return *std::move(address);
}

void check_addresses(const std::vector<std::string>& texts)
{
    for (const std::string& text : texts) {
        static_cast<void>(parse_address(text));
    }
}

std::vector<NodeId> ids_of(const std::vector<NamedNode>& nodes)
{
    std::vector<NodeId> ids;
    ids.reserve(nodes.size());
    for (const NamedNode& node : nodes) {
        ids.push_back(node.id.value_or(NodeId{}));
    }
    return ids;
}

std::vector<NamedNode> find_nodes(Connection& connection, const std::vector<std::string>& texts)
{
    std::vector<client::NodeAddress> addresses;
    addresses.reserve(texts.size());
    for (const std::string& text : texts) {
        addresses.push_back(parse_address(text));
    }
    using Resolved = std::vector<client::ResolvedNode>;
    const auto resolved = connection.wait_for<Resolved>([&](std::function<void(Resolved)> done) {
        client::resolve_nodes(connection.client(), std::move(addresses), std::move(done));
    });
    std::vector<NamedNode> nodes;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        nodes.push_back({texts[i], resolved[i].id, {}});
        for (const client::NodeAddress& candidate : resolved[i].candidates) {
            nodes.back().candidates.push_back(candidate.text());
        }
    }
    return nodes;
}

NodeId find_node(Connection& connection, const std::string& text)
{
    return id_of(connection, find_nodes(connection, {text}).front());
}

NodeId id_of(const Connection& connection, const NamedNode& node)
{
    if (!node.candidates.empty()) {
        throw failure_of(node, node.id.error());
    }
    return connection.value(node.id, node.text);
}

void refuse_ambiguous(Connection& connection, const std::vector<std::string>& texts)
{
    for (const NamedNode& node : find_nodes(connection, texts)) {
        if (!node.candidates.empty()) {
            throw failure_of(node, node.id.error());
        }
    }
}

client::ExplainedCall call_explained(Connection& connection, CallMethodRequest request,
                                     Duration timeout)
{
    using Results = std::vector<client::ExplainedCall>;
    auto results = connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::call_explained(connection.client(), {std::move(request)}, std::move(done),
                               client::RequestOptions{.timeout = timeout});
    });
    return std::move(results.front());
}

std::string operand_of(const NodeId& object, const NodeId& method)
{
    return to_string(method) + " of " + to_string(object);
}

Failure failure_of(const NamedNode& node, StatusCode status)
{
    Failure failure{status, node.text};
    if (!node.candidates.empty()) {
        failure.hint = "give one of these instead";
        failure.candidates = node.candidates;
    }
    return failure;
}

void print_candidates(Output& err, const std::vector<NamedNode>& nodes)
{
    for (const NamedNode& node : nodes) {
        if (!node.candidates.empty()) {
            err.line("busbar: " + safe(node.text) + " may be" + lines_of(node.candidates));
        }
    }
}

void append_candidates(JsonLine& json, const NamedNode& node)
{
    if (!node.candidates.empty()) {
        json.key("candidates").texts(node.candidates);
    }
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

} // namespace busbar::tool
