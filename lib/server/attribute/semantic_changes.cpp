#include "write_effects.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>

#include "server/rights/node_rights.hpp"

namespace busbar::server::detail {

namespace {

/// Part 8, 5.3.2.2 (analog items), 5.3.3.2 to 5.3.3.4 (discrete ones) and 5.3.4 (arrays).
constexpr std::array<std::string_view, 15> semantic_properties{
    "EURange",         "EUNumberRange",   "EngineeringUnits",
    "FalseState",      "TrueState",       "EnumStrings",
    "EnumValues",      "InstrumentRange", "Title",
    "XAxisDefinition", "YAxisDefinition", "ZAxisDefinition",
    "AxisDefinition",  "AxisScaleType",   "InstrumentNumberRange",
};

bool is_semantic(const model::AddressSpace& space, model::NodeIndex property)
{
    if (has_access(space.variable(property).access_level, AccessLevelType::SemanticChange)) {
        return true;
    }
    const QualifiedName name = space.browse_name(property);
    return name.namespace_index == 0 &&
           std::find(semantic_properties.begin(), semantic_properties.end(), name.name.view()) !=
               semantic_properties.end();
}

/// Adds the Variables that have the property.
void add_owners(const model::AddressSpace& space, model::NodeIndex property,
                std::unordered_set<NodeId>& owners)
{
    model::ReferenceCursor cursor = space.references(property);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward && space.is_subtype_of(reference->type, id::HasProperty) &&
            space.node_class(reference->target) == NodeClass::Variable) {
            owners.insert(space.node_id(reference->target));
        }
    }
}

} // namespace

std::unordered_set<NodeId> find_semantic_changes(const model::AddressSpace& space,
                                                 const WriteRequest& request,
                                                 std::span<const model::NodeHandle> nodes,
                                                 FunctionRef<StatusCode(std::size_t)> result)
{
    std::unordered_set<NodeId> owners;
    std::vector<model::NodeIndex> found(nodes.size());
    space.resolve_nodes(nodes, found);
    for (std::size_t i = 0; i < request.nodes_to_write.size(); ++i) {
        const WriteValue& written = request.nodes_to_write[i];
        const model::NodeIndex node = found[i];
        if (!result(i).is_bad() && node != model::no_node &&
            written.attribute_id == static_cast<std::uint32_t>(AttributeId::Value) &&
            space.node_class(node) == NodeClass::Variable && is_semantic(space, node)) {
            add_owners(space, node, owners);
        }
    }
    return owners;
}

} // namespace busbar::server::detail
