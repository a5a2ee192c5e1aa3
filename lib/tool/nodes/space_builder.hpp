#pragma once

#include <string>
#include <vector>

#include <busbar/model/address_space.hpp>

#include "remote_nodes.hpp"

namespace busbar::tool {

/// Copies nodes of a server into an AddressSpace of namespace 0.
class SpaceBuilder {
public:
    /// The namespaces get the indices that they have at the server; throws Failure if two have one
    /// URI.
    explicit SpaceBuilder(const std::vector<std::string>& namespaces);

    /// Adds the nodes, each when its parent and its types are there, and then their references.
    void add(const std::vector<RemoteNode>& nodes);

    [[nodiscard]] const model::AddressSpace& space() const { return space_; }
    /// Nodes without a place: their parent or a type is not known.
    [[nodiscard]] const std::vector<NodeId>& left_out() const { return left_out_; }
    /// Variables whose value is not of their DataType, which are without value here.
    [[nodiscard]] const std::vector<NodeId>& without_value() const { return without_value_; }

private:
    [[nodiscard]] bool add_node(const RemoteNode& node);
    [[nodiscard]] Result<model::NodeIndex> add_as(const RemoteNode& node,
                                                  const model::NewNode& what, bool with_value);
    [[nodiscard]] Result<model::NodeIndex>
    add_variable(const RemoteNode& node, const model::NewNode& what, bool with_value);
    [[nodiscard]] Result<model::NodeIndex> add_type(const RemoteNode& node,
                                                    const model::NewNode& what, bool with_value);
    [[nodiscard]] bool is_parent_reference(const RemoteNode& node,
                                           const ReferenceDescription& reference) const;
    void add_references(const RemoteNode& node);

    model::AddressSpace space_;
    std::vector<NodeId> left_out_;
    std::vector<NodeId> without_value_;
};

} // namespace busbar::tool
