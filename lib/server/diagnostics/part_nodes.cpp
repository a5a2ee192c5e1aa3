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

/// A Variable as `declaration` has it; no_node if there is none.
model::NodeIndex add_like(model::AddressSpace& space, model::NodeIndex declaration,
                          model::NewNode node, std::uint32_t type, std::uint64_t handle)
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
    node.id = NodeId{node.id.namespace_index(), "SessionDiagnostics." + std::to_string(handle)};
    return space.add_variable(node, variable).value_or(model::no_node);
}

void protect(model::AddressSpace& space, model::NodeIndex node, const model::NodeAccess* access)
{
    if (access != nullptr && node != model::no_node) {
        space.set_node_access(node, model::NodeAccess{*access});
    }
}

} // namespace

model::NodeIndex add_part(model::AddressSpace& space, model::NodeIndex parent,
                          std::uint16_t name_space, std::uint32_t number, const PartNodes& part)
{
    model::NewNode node;
    node.id = NodeId{name_space, 0U};
    node.browse_name = QualifiedName{part.name_space, String{part.name}};
    node.parent = parent;
    const model::NodeIndex made =
        add_like(space, part.declaration, node, part.type, handle_of(number, part.section, 0));
    if (made == model::no_node) {
        return made;
    }
    busbar::detail::Undo undo{[&] { static_cast<void>(space.remove(made)); }};
    protect(space, made, part.access);
    node.parent = made;
    for (std::size_t i = 0; i < part.fields.size(); ++i) {
        node.browse_name = QualifiedName{0, part.fields[i]};
        const auto declaration = find_component(space, part.type, node.browse_name);
        protect(space,
                add_like(space, declaration, node, id::BaseDataVariableType,
                         handle_of(number, part.section, i + 1)),
                part.access);
    }
    undo.keep();
    return made;
}

} // namespace busbar::server::detail
