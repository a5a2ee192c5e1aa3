#include "declarations.hpp"

#include <algorithm>
#include <map>

#include <busbar/types/ids.hpp>

namespace busbar::model::detail {

ModellingRule modelling_rule_of(const SpaceReader& space, NodeIndex node)
{
    const NodeIndex has_rule = space.find(id::HasModellingRule);
    ReferenceCursor cursor = space.references(node);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward || reference->type != has_rule) {
            continue;
        }
        const NodeId rule = space.node_id(reference->target);
        if (rule.is(id::ModellingRule_Mandatory)) {
            return ModellingRule::Mandatory;
        }
        return rule.is(id::ModellingRule_Optional) ? ModellingRule::Optional : ModellingRule::None;
    }
    return ModellingRule::None;
}

std::vector<NodeIndex> interfaces_of(const SpaceReader& space, NodeIndex node)
{
    std::vector<NodeIndex> found;
    ReferenceCursor cursor = space.references(node);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && space.is_subtype_of(reference->type, id::HasInterface)) {
            found.push_back(reference->target);
        }
    }
    return found;
}

std::vector<NodeIndex> types_above(const SpaceReader& space, NodeIndex type)
{
    std::vector<NodeIndex> types;
    for (NodeIndex at = type; at != no_node; at = space.supertype(at)) {
        types.push_back(at);
    }
    // Interfaces follow all types: an ObjectType repeats the declarations of an Interface.
    // Interfaces do not refer to Interfaces but have supertypes (Part 3, 4.10.2).
    const std::size_t type_count = types.size();
    for (std::size_t i = 0; i < type_count; ++i) {
        for (const NodeIndex implemented : interfaces_of(space, types[i])) {
            for (NodeIndex at = implemented;
                 at != no_node && std::find(types.begin(), types.end(), at) == types.end();
                 at = space.supertype(at)) {
                types.push_back(at);
            }
        }
    }
    return types;
}

std::vector<DeclaredMember> members_of(const SpaceReader& space,
                                       std::span<const DeclarationSource> sources)
{
    std::vector<DeclaredMember> members;
    std::map<QualifiedName, std::size_t> by_name;
    for (const DeclarationSource& source : sources) {
        ReferenceCursor cursor = space.references(source.node);
        while (const auto reference = cursor.next()) {
            if (!reference->is_forward ||
                !space.is_subtype_of(reference->type, id::HierarchicalReferences) ||
                space.is_subtype_of(reference->type, id::HasSubtype)) {
                continue;
            }
            // Nodes without a rule belong to the type itself: states, transitions, ...
            const ModellingRule rule = modelling_rule_of(space, reference->target);
            if (rule == ModellingRule::None) {
                continue;
            }
            const auto [place, is_new] =
                by_name.try_emplace(space.browse_name(reference->target), members.size());
            if (is_new) {
                members.push_back({{}, reference->type, rule});
            }
            DeclaredMember& member = members[place->second];
            const DeclarationSource declaration{reference->target, source.scope};
            if (std::find(member.declarations.begin(), member.declarations.end(), declaration) ==
                member.declarations.end()) {
                member.declarations.push_back(declaration);
            }
            // An overriding declaration may turn Optional into Mandatory, never the other way (Part
            // 3, 6.4.4.2); a Mandatory one of an Interface applies too.
            if (rule == ModellingRule::Mandatory) {
                member.rule = rule;
            }
        }
    }
    return members;
}

} // namespace busbar::model::detail
