#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "tables.hpp"

#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::model::detail {

/// Adds many nodes of any NodeClass, which may refer to one another in any order, to an
/// AddressSpace: create each, fill its NodeRecord, add the references, link, keep. Without keep()
/// everything is removed again, types and namespaces too.
///
/// Makes only the checks that keep the AddressSpace consistent; the caller is responsible for the
/// nodes.
class BUSBAR_API Graft {
public:
    explicit Graft(AddressSpace& space);
    Graft(const Graft&) = delete;
    Graft& operator=(const Graft&) = delete;
    ~Graft();

    void reserve(std::size_t node_count);
    [[nodiscard]] Result<std::uint16_t> add_namespace(std::string_view uri);
    /// Returns Bad_NodeIdExists, or Bad_OutOfMemory past the number of records.
    [[nodiscard]] Result<NodeIndex> create(const NodeId& id, const QualifiedName& name,
                                           NodeClass node_class);
    /// Returns the record of a created node.
    [[nodiscard]] NodeRecord& record(NodeIndex node) { return tables_.record(node); }
    void set_access(NodeIndex node, NodeAccess access)
    {
        space_.set_node_access(node, std::move(access));
    }
    [[nodiscard]] const std::vector<NodeIndex>& created() const { return created_; }
    /// Adds a reference from `source` to `target`. One that was added before is counted once; one
    /// between two old nodes is not added.
    void add_reference(NodeIndex source, NodeIndex type, NodeIndex target);
    /// Sets the place of every created node: its parent, supertype, type definition and references.
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
    /// Place in `created_` + 1, by record number.
    std::vector<std::uint32_t> positions_;
    std::vector<Link> links_;
    std::vector<NodeIndex> supertypes_;
    /// Place of the node above, by place in `created_`, shortened as it is followed.
    std::vector<std::uint32_t> above_;
    /// Old nodes that got references.
    std::vector<NodeIndex> touched_;
    bool is_kept_{false};
};

} // namespace busbar::model::detail
