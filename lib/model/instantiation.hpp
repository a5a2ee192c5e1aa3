#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/model/instance.hpp>

#include "declarations.hpp"

namespace busbar::model::detail {

/// Memory of a reference at both ends, in growing lists.
inline constexpr std::size_t bytes_per_reference = 64;

/// Returns the child of a hierarchical reference, no_node if there is none of this name.
[[nodiscard]] NodeIndex child_of(const SpaceReader& space, NodeIndex parent,
                                 const QualifiedName& name);

/// Returns the NodeId of a new child with this name.
[[nodiscard]] NodeId id_below(AddressSpace& space, NodeIndex parent, const QualifiedName& name,
                              InstanceIds ids);

/// Returns a new child with this name and an id_below the parent.
[[nodiscard]] NewNode child_node(AddressSpace& space, NodeIndex parent, const QualifiedName& name);

/// Returns the instance's member with this name, which is added if its type has it as Optional.
[[nodiscard]] Result<NodeIndex> optional_member(AddressSpace& space, NodeIndex instance,
                                                const char* name);

/// One call of instantiate or add_interface.
class Instantiation {
public:
    Instantiation(AddressSpace& space, const InstanceOptions& options)
        : space_{space}, options_{options}, used_(options.optional.size(), false)
    {
    }

    [[nodiscard]] Result<NodeIndex> create(const NewNode& node, NodeIndex type);
    /// Adds the missing members of `type`, an Interface or the type of the instance.
    [[nodiscard]] Result<void> complete(NodeIndex instance, NodeIndex type);
    [[nodiscard]] Result<void> extend(NodeIndex object, NodeIndex interface_type);

private:
    struct AddedReference {
        NodeIndex source{no_node};
        NodeId type;
        NodeIndex target{no_node};
    };

    [[nodiscard]] Result<NodeIndex> create_root(const NewNode& node, NodeIndex type);
    [[nodiscard]] Result<NodeIndex> create_variable(const NewNode& node, NodeIndex type);
    [[nodiscard]] Result<void> add_members(NodeIndex parent,
                                           std::span<const DeclarationSource> sources,
                                           const std::string& path, std::size_t depth);
    [[nodiscard]] Result<void> add_member(NodeIndex parent, const DeclaredMember& member,
                                          const std::string& path, std::size_t depth);
    [[nodiscard]] Result<NodeIndex> copy(NodeIndex parent, const DeclaredMember& member,
                                         const std::string& path);
    [[nodiscard]] Result<void> copy_arguments(NodeIndex method, const DeclaredMember& member);
    /// `type` is the new node's type, no_node for a Method.
    [[nodiscard]] Result<void> copy_node(NodeIndex parent, NodeIndex declaration, NodeIndex type,
                                         NodeIndex reference_type, NodeIndex& created);
    /// Returns the type of the member at this BrowsePath, or no_node if none fits.
    [[nodiscard]] NodeIndex type_of(NodeIndex declaration, const std::string& path) const;
    [[nodiscard]] bool can_be_made(const DeclaredMember& member, const std::string& path) const;
    [[nodiscard]] Result<void> add_other_references();
    [[nodiscard]] Result<void> reference(NodeIndex source, NodeIndex type, NodeIndex target);
    /// Counts the new node and its memory.
    [[nodiscard]] Result<void> note_created(NodeIndex node);
    [[nodiscard]] Result<void> charge(std::size_t bytes);
    [[nodiscard]] std::vector<DeclarationSource> with_types(std::vector<DeclarationSource> sources,
                                                            NodeIndex type);
    [[nodiscard]] bool is_wanted(const DeclaredMember& member, const std::string& path);
    [[nodiscard]] NodeIndex instance_of(const DeclaredMember& member) const;
    [[nodiscard]] Result<void> check_paths() const;
    void undo();

    AddressSpace& space_;
    const InstanceOptions& options_;
    /// For each entry of InstanceOptions::optional, whether the type has it.
    std::vector<bool> used_;
    std::map<DeclarationSource, NodeIndex> instances_;
    std::vector<NodeIndex> created_;
    std::vector<AddedReference> references_;
    std::uint32_t last_scope_{0};
    std::size_t memory_{0};
};

} // namespace busbar::model::detail
