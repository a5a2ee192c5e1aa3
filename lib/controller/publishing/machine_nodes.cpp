#include <busbar/controller/machine_nodes.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

#include "machine_configuration.hpp"
#include "shape.hpp"

namespace busbar::controller {

namespace {

constexpr std::uint8_t event_notifier_bit = 0x01; // EventNotifierType, Part 3, 8.59

constexpr std::array<std::string_view, 2> mode_names{"PROGRAM", "RUN"};
constexpr std::array<std::string_view, 3> error_state_names{"NoError", "MajorFault",
                                                            "ContinuousError"};

model::NewNode machine_node(std::uint16_t namespace_index, std::string_view id,
                            std::string_view browse_name, model::NodeIndex parent)
{
    model::NewNode node;
    node.id = NodeId{namespace_index, String{id}};
    node.browse_name = QualifiedName{namespace_index, String{browse_name}};
    node.parent = parent;
    return node;
}

/// Adds a Property with this value and its DataType.
Result<model::NodeIndex> add_machine_property(model::AddressSpace& space,
                                              const model::NewNode& node, Variant value)
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, static_cast<std::uint32_t>(value.type())};
    variable.value = std::move(value);
    return space.add_property(node, std::move(variable));
}

/// Writes the Property's value. This fails only if a client has deleted the node; then the value is
/// not needed.
void set_property(model::AddressSpace& space, model::NodeHandle property, Variant value)
{
    const model::NodeIndex node = space.resolve(property);
    if (node != model::no_node) {
        static_cast<void>(space.set_value(node, std::move(value)));
    }
}

std::uint32_t clamped(std::uint64_t count)
{
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(count, UINT32_MAX));
}

Problem variable_problem(const PublishedVariable& variable, StatusCode code)
{
    return {code, "variables (" + printable(variable.variable->name) + ")",
            "cannot be made a node"};
}

} // namespace

std::string_view name(OperatingMode mode)
{
    return mode_names[static_cast<std::size_t>(mode)];
}

std::string_view name(ErrorState state)
{
    return error_state_names[static_cast<std::size_t>(state)];
}

MachineNodes::MachineNodes(const model::SpaceReader& space, std::uint16_t namespace_index,
                           const MachineNodesOptions& options)
    : namespace_index_{namespace_index}, source_{options.source}, cycle_{options.cycle},
      types_{space, namespace_index, options.types}
{
}

Configured<MachineNodes> MachineNodes::create(model::AddressSpace& space, const Program& program,
                                              const Publication& publication,
                                              const MachineNodesOptions& options)
{
    const auto namespace_index = space.add_namespace(options.namespace_uri);
    if (!namespace_index) {
        return misconfigured("namespace_uri", "cannot be added", namespace_index.error());
    }
    MachineNodes nodes{space, *namespace_index, options};
    if (const auto frame = nodes.add_frame(space, options); !frame) {
        return misconfigured("controller_name", "cannot be made a folder", frame.error());
    }
    auto plcopen_vars =
        detail::add_machine_configuration(space, *namespace_index, program, options);
    if (!plcopen_vars) {
        return Unexpected<Problem>{std::move(plcopen_vars.error())};
    }
    if (*plcopen_vars != model::no_node) {
        nodes.plcopen_vars_ = space.handle(*plcopen_vars);
    }
    if (auto added = nodes.add_variables(space, publication); !added) {
        return Unexpected<Problem>{std::move(added.error())};
    }
    // Add this last, so that nodes present from the start are not reported as changes (Part 3,
    // 9.32.2).
    if (const auto version = nodes.add_version(space); !version) {
        return misconfigured("controller_name", "cannot be given a NodeVersion", version.error());
    }
    return nodes;
}

Result<void> MachineNodes::add_frame(model::AddressSpace& space, const MachineNodesOptions& options)
{
    model::NewObject folder_type;
    folder_type.type_definition = NodeId{0, id::FolderType};
    folder_type.event_notifier = options.has_events ? event_notifier_bit : std::uint8_t{0};
    const auto folder =
        space.add_object(machine_node(namespace_index_, "Controller/", options.controller_name,
                                      space.find(id::ObjectsFolder)),
                         folder_type);
    if (!folder) {
        return fail(folder.error());
    }
    model::NewNode node =
        machine_node(namespace_index_, "Controller/DeviceState", "DeviceState", *folder);
    node.reference_type = NodeId{0, id::HasComponent};
    const auto state = space.add_object(node);
    if (!state) {
        return fail(state.error());
    }
    const auto variables = space.add_folder(
        machine_node(namespace_index_, "Controller/GlobalVars", "GlobalVars", *folder));
    if (!variables) {
        return fail(variables.error());
    }
    folder_ = space.handle(*folder);
    device_state_ = space.handle(*state);
    global_vars_ = space.handle(*variables);
    return add_properties(space);
}

Result<void> MachineNodes::add_properties(model::AddressSpace& space)
{
    const auto text = [](std::string_view of) { return Variant{String::borrow(of)}; };
    struct Row {
        std::string_view name;
        Variant value;
        model::NodeHandle& handle;
    };
    const Row rows[] = {
        {"ErrorState", text(name(ErrorState::NoError)), properties_.error_state},
        {"Mode", text(name(OperatingMode::Program)), properties_.mode},
        {"UnpublishedVariablesStatus", Variant{std::uint16_t{0}}, properties_.status},
        {"NumberOfPublishedVariables", Variant{std::uint32_t{0}}, properties_.variables},
        {"NumberOfValueAttributes", Variant{std::uint32_t{0}}, properties_.values},
    };
    for (const Row& row : rows) {
        const auto added = add_machine_property(
            space,
            machine_node(namespace_index_, "Controller/DeviceState/" + std::string{row.name},
                         row.name, space.resolve(device_state_)),
            row.value);
        if (!added) {
            return fail(added.error());
        }
        row.handle = space.handle(*added);
    }
    return {};
}

Result<void> MachineNodes::add_version(model::AddressSpace& space) const
{
    model::NewNode node = machine_node(namespace_index_, "Controller/GlobalVars/NodeVersion",
                                       "NodeVersion", space.resolve(global_vars_));
    node.browse_name.namespace_index = 0;
    const auto added = add_machine_property(space, node, Variant{"1"});
    return added ? Result<void>{} : fail(added.error());
}

Configured<void> MachineNodes::add_variables(model::AddressSpace& space,
                                             const Publication& publication,
                                             std::span<const std::uint32_t> handles)
{
    const std::span<const PublishedVariable> all{publication.published()};
    if (auto types = types_.add(space, all.subspan(added_)); !types) {
        return types;
    }
    space.reserve(all.size() - added_);
    std::vector<model::NodeIndex> nodes;
    for (std::size_t i = added_; i < all.size(); ++i) {
        const auto node = add_variable(space, all[i], i < handles.size() ? handles[i] : i);
        if (!node) {
            for (const model::NodeIndex each : nodes) {
                static_cast<void>(space.remove(each));
            }
            return Unexpected<Problem>{variable_problem(all[i], node.error())};
        }
        nodes.push_back(*node);
    }
    added_ = all.size();
    set_publication(space, publication);
    return {};
}

void MachineNodes::remove_variables(model::AddressSpace& space, std::span<const std::string> names)
{
    for (const std::string& name : names) {
        const model::NodeIndex node = space.find(NodeId{namespace_index_, String{name}});
        if (node != model::no_node && space.remove(node)) {
            --added_;
        }
    }
}

Result<model::NodeIndex> MachineNodes::add_variable(model::AddressSpace& space,
                                                    const PublishedVariable& variable,
                                                    std::size_t handle) const
{
    const GlobalVariable& declared = *variable.variable;
    const ResolvedType type = variable.program->resolve(declared.type);
    model::NewVariable attributes;
    attributes.data_type = types_.of(type).data_type;
    attributes.value_rank = detail::value_rank(type);
    attributes.array_dimensions = detail::array_dimensions(type);
    attributes.access_level = declared.is_constant ? model::Access::Read : model::Access::ReadWrite;
    attributes.minimum_sampling_interval = to_milliseconds(cycle_);
    attributes.source = source_;
    attributes.handle = handle;
    const auto node = space.add_variable(
        machine_node(namespace_index_, declared.name, declared.name, space.resolve(global_vars_)),
        attributes);
    if (node) {
        if (const auto organized = organize(space, *node); !organized) {
            static_cast<void>(space.remove(*node));
            return fail(organized.error());
        }
    }
    return node;
}

Result<void> MachineNodes::organize(model::AddressSpace& space, model::NodeIndex variable) const
{
    const model::NodeIndex group = space.resolve(plcopen_vars_);
    return group == model::no_node ? Result<void>{}
                                   : space.add_reference(group, NodeId{0, id::Organizes}, variable);
}

void MachineNodes::set_mode(model::AddressSpace& space, OperatingMode mode) const
{
    set_property(space, properties_.mode, Variant{String::borrow(name(mode))});
}

void MachineNodes::set_error_state(model::AddressSpace& space, ErrorState state) const
{
    set_property(space, properties_.error_state, Variant{String::borrow(name(state))});
}

void MachineNodes::set_publication(model::AddressSpace& space, const Publication& publication) const
{
    set_property(space, properties_.status, Variant{publication.status_bits()});
    set_property(space, properties_.variables, Variant{clamped(publication.published().size())});
    set_property(space, properties_.values, Variant{clamped(publication.values())});
}

} // namespace busbar::controller
