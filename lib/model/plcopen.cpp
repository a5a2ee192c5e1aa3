#include <busbar/model/plcopen.hpp>

#include <busbar/types/ids.hpp>

#include "instantiation.hpp"

namespace busbar::model {

namespace {

bool is_of_type(const SpaceReader& space, NodeIndex node, std::uint32_t type)
{
    return space.exists(node) &&
           space.is_subtype_of(space.type_definition(node), find_plcopen(space, type));
}

/// True for a program or function block, or a type of these.
bool is_unit(const SpaceReader& space, NodeIndex node)
{
    if (!space.exists(node)) {
        return false;
    }
    const NodeIndex type =
        space.node_class(node) == NodeClass::ObjectType ? node : space.type_definition(node);
    return space.is_subtype_of(type,
                               find_plcopen(space, plcopen_id::CtrlProgramOrganizationUnitType));
}

NodeId plcopen_node(const SpaceReader& space, std::uint32_t number)
{
    const NodeIndex node = find_plcopen(space, number);
    return node == no_node ? NodeId{} : space.node_id(node);
}

/// Returns the member of a configuration or resource that contains objects of one kind.
Result<NodeIndex> collection(AddressSpace& space, NodeIndex owner, std::uint32_t type,
                             const char* name)
{
    if (!is_of_type(space, owner, type)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return detail::optional_member(space, owner, name);
}

/// A member that a type declares exists in each instance.
Result<NodeIndex> declared(AddressSpace& space, NodeIndex unit, const Result<NodeIndex>& node)
{
    if (node && space.node_class(unit) == NodeClass::ObjectType) {
        const auto ruled = space.add_reference(*node, NodeId{0, id::HasModellingRule},
                                               space.find(id::ModellingRule_Mandatory));
        if (!ruled) {
            static_cast<void>(space.remove(*node));
            return fail(ruled.error());
        }
    }
    return node;
}

Result<NodeIndex> add_unit_type(AddressSpace& space, const QualifiedName& name,
                                std::uint32_t supertype)
{
    NewNode node;
    node.browse_name = name;
    node.parent = find_plcopen(space, supertype);
    if (node.parent == no_node) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return space.add_object_type(node);
}

} // namespace

NodeIndex find_plcopen(const SpaceReader& space, std::uint32_t number)
{
    const auto index = space.namespace_index(plcopen_uri);
    return index ? space.find(NodeId{*index, number}) : no_node;
}

Result<NodeIndex> add_ctrl_configuration(AddressSpace& space, NewNode node,
                                         const InstanceOptions& options)
{
    if (node.parent == no_node) {
        node.parent = find_di(space, di_id::DeviceSet);
    }
    return instantiate(space, node, find_plcopen(space, plcopen_id::CtrlConfigurationType),
                       options);
}

Result<NodeIndex> add_ctrl_resource(AddressSpace& space, NodeIndex configuration,
                                    const QualifiedName& name, const Nameplate& nameplate,
                                    const InstanceOptions& options)
{
    const auto resources =
        collection(space, configuration, plcopen_id::CtrlConfigurationType, "Resources");
    if (!resources) {
        return resources;
    }
    return add_device(space, detail::child_node(space, *resources, name),
                      find_plcopen(space, plcopen_id::CtrlResourceType), nameplate, options);
}

Result<NodeIndex> add_ctrl_task(AddressSpace& space, NodeIndex resource, const QualifiedName& name,
                                const CtrlTask& task)
{
    const auto tasks = collection(space, resource, plcopen_id::CtrlResourceType, "Tasks");
    if (!tasks) {
        return tasks;
    }
    InstanceOptions options;
    std::vector<std::pair<const char*, Variant>> values;
    values.emplace_back("Priority", task.priority);
    if (!task.interval.is_null()) {
        values.emplace_back("Interval", task.interval);
    }
    if (!task.single.is_null()) {
        values.emplace_back("Single", task.single);
    }
    for (const auto& [property, value] : values) {
        options.optional.emplace_back(property);
    }
    const auto created = instantiate(space, detail::child_node(space, *tasks, name),
                                     find_plcopen(space, plcopen_id::CtrlTaskType), options);
    for (const auto& [property, value] : values) {
        if (!created) {
            break;
        }
        if (auto set = space.set_value(find_by_path(space, *created, property), value); !set) {
            static_cast<void>(space.remove(*created));
            return fail(set.error());
        }
    }
    return created;
}

Result<NodeIndex> add_program_type(AddressSpace& space, const QualifiedName& name)
{
    return add_unit_type(space, name, plcopen_id::CtrlProgramType);
}

Result<NodeIndex> add_function_block_type(AddressSpace& space, const QualifiedName& name)
{
    return add_unit_type(space, name, plcopen_id::CtrlFunctionBlockType);
}

Result<NodeIndex> add_pou_variable(AddressSpace& space, NodeIndex unit, PouVariable section,
                                   const QualifiedName& name, const NewVariable& variable)
{
    if (!is_unit(space, unit)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    NewNode node = detail::child_node(space, unit, name);
    node.reference_type = plcopen_node(space, static_cast<std::uint32_t>(section));
    return declared(space, unit, space.add_variable(node, variable));
}

Result<void> add_external_variable(AddressSpace& space, NodeIndex unit, NodeIndex global)
{
    if (!is_unit(space, unit)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return space.add_reference(unit, plcopen_node(space, plcopen_id::HasExternalVar), global);
}

Result<NodeIndex> add_program(AddressSpace& space, NodeIndex resource, const QualifiedName& name,
                              NodeIndex type, NodeIndex task)
{
    const auto programs = collection(space, resource, plcopen_id::CtrlResourceType, "Programs");
    const bool fits = space.exists(type) &&
                      space.is_subtype_of(type, find_plcopen(space, plcopen_id::CtrlProgramType)) &&
                      (task == no_node || is_of_type(space, task, plcopen_id::CtrlTaskType));
    if (!programs || !fits) {
        return fail(programs ? status::Bad_TypeDefinitionInvalid : programs.error());
    }
    const auto program = instantiate(space, detail::child_node(space, *programs, name), type);
    if (program && task != no_node) {
        const auto with =
            space.add_reference(*program, plcopen_node(space, plcopen_id::With), task);
        if (!with) {
            static_cast<void>(space.remove(*program));
            return fail(with.error());
        }
    }
    return program;
}

Result<NodeIndex> add_function_block(AddressSpace& space, NodeIndex unit, const QualifiedName& name,
                                     NodeIndex type)
{
    const bool fits =
        is_unit(space, unit) && space.exists(type) &&
        space.is_subtype_of(type, find_plcopen(space, plcopen_id::CtrlFunctionBlockType));
    if (!fits) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    NewNode node = detail::child_node(space, unit, name);
    node.reference_type = plcopen_node(space, plcopen_id::HasLocalVar);
    return declared(space, unit, instantiate(space, node, type));
}

Result<NodeIndex> add_global_variable(AddressSpace& space, NodeIndex owner,
                                      const QualifiedName& name, const NewVariable& variable)
{
    const bool is_configuration = is_of_type(space, owner, plcopen_id::CtrlConfigurationType);
    const auto globals = collection(space, owner,
                                    is_configuration ? plcopen_id::CtrlConfigurationType
                                                     : plcopen_id::CtrlResourceType,
                                    "GlobalVars");
    return globals ? space.add_variable(detail::child_node(space, *globals, name), variable)
                   : globals;
}

} // namespace busbar::model
