#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/core/expected.hpp>
#include <busbar/model/static_nodes.hpp>

#include "hierarchy.hpp"
#include "node_values.hpp"
#include "options.hpp"

namespace busbar::generator {

/// One of the long tables of bytes; equal pieces are there once.
class Pool {
public:
    [[nodiscard]] model::StaticText add(const std::string& piece);
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::unordered_map<std::string, model::StaticText> pieces_;
};

/// The tables of model::StaticNodes, being filled.
struct NodeTables {
    std::vector<model::StaticText> namespaces;
    std::vector<model::StaticNode> nodes;
    std::vector<model::StaticType> types;
    std::vector<model::StaticVariable> variables;
    std::vector<model::StaticReference> references;
    std::vector<std::uint32_t> reference_types;
    std::vector<model::StaticIdentifier> externals;
    std::vector<model::StaticText> texts;
    std::vector<model::StaticExtra> extras;
    std::vector<std::uint32_t> dimensions;
    std::vector<std::uint16_t> slots;
    std::vector<model::StaticAccess> access;
    std::uint16_t restrictions{0};
    Pool text;
    Pool values;
};

/// Fills NodeTables from a document.
class NodeTableBuilder {
public:
    NodeTableBuilder(const nodeset::Document& document, const Options& options);

    [[nodiscard]] Expected<NodeTables, Failure> build();

private:
    struct Link {
        NodeId type;
        NodeId target;
        bool is_forward;
    };

    [[nodiscard]] Expected<void, Failure> select();
    [[nodiscard]] Expected<void, Failure> select_addition(std::set<NodeId> others);
    void order();
    void order_below(const nodeset::Node& type);
    void collect_links();
    void add_link(const NodeId& source, const NodeId& type, const NodeId& target);
    [[nodiscard]] Expected<void, Failure> add_node(const nodeset::Node& node);
    [[nodiscard]] Expected<std::uint32_t, Failure> details(const nodeset::Node& node);
    [[nodiscard]] Expected<std::uint32_t, Failure> variable(const nodeset::Node& node);
    [[nodiscard]] Expected<void, Failure> add_references(const nodeset::Node& node);
    void add_extras(const nodeset::Node& node);
    void add_access(const nodeset::Node& node);
    [[nodiscard]] model::StaticIdentifier identifier(const NodeId& id);
    /// The node's index, or past the last node that of an external.
    [[nodiscard]] std::uint32_t index(const NodeId& id);
    [[nodiscard]] bool is_emitted(const NodeId& id) const { return indices_.count(id) != 0; }
    /// Tells whether a small namespace leaves the node and references to it out.
    [[nodiscard]] bool is_left_out(const NodeId& id) const;
    void fill_slots();

    const nodeset::Document& document_;
    const Options& options_;
    Hierarchy hierarchy_;
    NodeValues values_;
    std::uint16_t namespace_{0};
    std::unordered_map<NodeId, const nodeset::Node*> selected_;
    /// The nodes of an addition that belong to features which are not emitted.
    std::set<NodeId> others_;
    std::unordered_map<NodeId, std::vector<const nodeset::Node*>> subtypes_;
    std::vector<const nodeset::Node*> ordered_;
    std::vector<std::uint32_t> lasts_;
    std::unordered_map<NodeId, std::uint32_t> indices_;
    std::unordered_map<NodeId, std::uint32_t> externals_;
    std::unordered_map<NodeId, std::uint32_t> reference_types_;
    std::unordered_map<NodeId, std::vector<Link>> links_;
    std::set<std::tuple<NodeId, NodeId, NodeId>> known_links_;
    NodeTables tables_;
};

} // namespace busbar::generator
