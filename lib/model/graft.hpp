#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "tables.hpp"

#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::model::detail {

/// Adds many nodes of any NodeClass, that may refer to one another in any order, to an
/// AddressSpace: create each, fill its NodeRecord, add the references, link, keep. Whatever was not
/// kept is taken back, types and namespaces too.
///
/// Checks no more than it must to stay sound; what the nodes are is up to the caller.
class BUSBAR_API Graft {
public:
    explicit Graft(AddressSpace& space);
    Graft(const Graft&) = delete;
    Graft& operator=(const Graft&) = delete;
    ~Graft();

    void reserve(std::size_t node_count);
    [[nodiscard]] Result<std::uint16_t> add_namespace(std::string_view uri);
    /// Bad_NodeIdExists, or Bad_OutOfMemory past the number of records.
    [[nodiscard]] Result<NodeIndex> create(const NodeId& id, const QualifiedName& name,
                                           NodeClass node_class);
    /// Of a node that was created.
    [[nodiscard]] NodeRecord& record(NodeIndex node) { return tables_.record(node); }
    void set_access(NodeIndex node, NodeAccess access)
    {
        space_.set_node_access(node, std::move(access));
    }
    [[nodiscard]] const std::vector<NodeIndex>& created() const { return created_; }
    /// From `source` to `target`. One that was added before counts once; one between two nodes
    /// that were there before is not added.
    void add_reference(NodeIndex source, NodeIndex type, NodeIndex target);
    /// Gives every created node its place: its parent, supertype, type definition and references.
    /// The parent is the source of the first hierarchical reference that makes no circle.
    void link();
    void keep() { is_kept_ = true; }

private:
    static constexpr std::uint32_t none = UINT32_MAX;

    struct Link {
        NodeIndex source;
        NodeIndex type;
        NodeIndex target;
        std::uint32_t order;
        bool is_used{false};
    };

    [[nodiscard]] std::uint32_t position(NodeIndex node) const;
    void remove_duplicates();
    void find_supertypes();
    void place_types();
    void place_type_below(NodeIndex type, NodeIndex supertype);
    void choose_parents();
    void add_others();
    [[nodiscard]] std::uint32_t root(std::uint32_t at);
    void attach(NodeIndex parent, NodeIndex type, NodeIndex child);
    void add_entry(NodeIndex node, const Entry& entry);
    void take_back();
    void forget_created(NodeIndex node);

    AddressSpace& space_;
    Tables& tables_;
    std::size_t namespace_count_;
    std::vector<NodeIndex> created_;
    /// By record number: the place in `created_` + 1.
    std::vector<std::uint32_t> positions_;
    std::vector<Link> links_;
    std::vector<NodeIndex> supertypes_;
    /// By place in `created_`: that of the node above, shortened as it is followed.
    std::vector<std::uint32_t> above_;
    /// Nodes that were there before and got references.
    std::vector<NodeIndex> touched_;
    bool is_kept_{false};
};

} // namespace busbar::model::detail
