#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include <busbar/model/space_reader.hpp>

/// The InstanceDeclarations of types, inherited and overridden as in Part 3, 6.3.3.
namespace busbar::model::detail {

enum class ModellingRule : std::uint8_t { None, Mandatory, Optional };

/// A type or InstanceDeclaration whose members are needed. One node may be reached in several
/// places of an instance, once for each Object of its type: `scope` tells these apart.
struct DeclarationSource {
    NodeIndex node{no_node};
    std::uint32_t scope{0};

    friend bool operator==(const DeclarationSource&, const DeclarationSource&) = default;
    friend bool operator<(const DeclarationSource& a, const DeclarationSource& b)
    {
        return std::tie(a.node, a.scope) < std::tie(b.node, b.scope);
    }
};

/// The member of an instance with one BrowseName.
struct DeclaredMember {
    /// The effective declaration comes first, followed by those that it overrides.
    std::vector<DeclarationSource> declarations;
    NodeIndex reference_type{no_node};
    ModellingRule rule{ModellingRule::None};

    [[nodiscard]] NodeIndex declaration() const { return declarations.front().node; }
};

/// Returns Mandatory or Optional; None for a placeholder and any other.
[[nodiscard]] ModellingRule modelling_rule_of(const SpaceReader& space, NodeIndex node);

/// Returns the type, its supertypes and the Interfaces of all of these, the most derived first.
[[nodiscard]] std::vector<NodeIndex> types_above(const SpaceReader& space, NodeIndex type);

/// Returns the Interfaces that the node refers to (Part 3, 4.10.2).
[[nodiscard]] std::vector<NodeIndex> interfaces_of(const SpaceReader& space, NodeIndex node);

/// Returns the Mandatory and Optional members of `sources`, of which earlier ones override later
/// ones.
[[nodiscard]] std::vector<DeclaredMember> members_of(const SpaceReader& space,
                                                     std::span<const DeclarationSource> sources);

} // namespace busbar::model::detail
