#include "part_nodes.hpp"

#include <string>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

namespace {

model::NodeIndex find_component(const model::AddressSpace& space, std::uint32_t type,
                                const QualifiedName& name)
{
    model::NodeIndex found = model::no_node;
    const model::NodeIndex parent = space.find(type);
    if (parent != model::no_node) {
        space.for_each_child(parent, space.find(id::HasComponent), true, name,
                             [&](model::NodeIndex component) {
                                 found = component;
                                 return false;
                             });
    }
    return found;
}

NodeId part_id(std::uint16_t name_space, std::uint64_t handle)
{
    return NodeId{name_space, "SessionDiagnostics." + std::to_string(handle)};
}

/// Adds a Variable like `declaration`, visible to those with `access`; no_node if there is no such
/// declaration.
model::NodeIndex add_like(model::AddressSpace& space, model::NodeIndex declaration,
                          const model::NewNode& node, std::uint32_t type, std::uint64_t handle,
                          const model::NodeAccess* access)
{
    if (declaration == model::no_node) {
        return model::no_node;
    }
    model::NewVariable variable;
    variable.data_type = space.data_type_id(declaration);
    variable.value_rank = space.variable(declaration).value_rank;
    variable.source = live_values_source;
    variable.handle = handle;
    variable.type_definition = NodeId{0, type};
    const auto made = space.add_variable(node, variable);
    if (!made) {
        return model::no_node;
    }
    busbar::detail::Undo undo{[&] { static_cast<void>(space.remove(*made)); }};
    if (access != nullptr) {
        space.set_node_access(*made, model::NodeAccess{*access});
    }
    undo.keep();
    return *made;
}

} // namespace

model::NodeIndex add_part(model::AddressSpace& space, model::NodeIndex parent,
                          std::uint16_t name_space, std::uint32_t number, const PartNodes& part)
{
    const std::uint64_t handle = handle_of(number, part.section, 0);
    model::NewNode node;
    node.id = part_id(name_space, handle);
    node.browse_name = QualifiedName{part.name_space, String{part.name}};
    node.parent = parent;
    return add_like(space, part.declaration, node, part.type, handle, part.access);
}

std::size_t add_fields(model::AddressSpace& space, model::NodeIndex made, std::uint16_t name_space,
                       std::uint32_t number, const PartNodes& part)
{
    std::size_t count = 0;
    model::NewNode node;
    node.parent = made;
    for (std::size_t i = 0; i < part.fields.size(); ++i) {
        const std::uint64_t handle = handle_of(number, part.section, i + 1);
        node.id = part_id(name_space, handle);
        if (space.find(node.id) != model::no_node) {
            continue;
        }
        node.browse_name = QualifiedName{0, part.fields[i]};
        const auto declaration = find_component(space, part.type, node.browse_name);
        const model::NodeIndex field =
            add_like(space, declaration, node, id::BaseDataVariableType, handle, part.access);
        count += field != model::no_node ? 1 : 0;
    }
    return count;
}

} // namespace busbar::server::detail
