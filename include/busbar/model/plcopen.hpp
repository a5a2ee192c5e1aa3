#pragma once

#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/model/device.hpp>

/// Adds the parts of an IEC 61131-3 controller as OPC 30000 shows them: a Configuration has
/// Resources, these have Tasks and Programs, which have FunctionBlocks and Variables.
///
///     const auto plc = add_ctrl_configuration(space, node).value();
///     const auto cpu = add_ctrl_resource(space, plc, {ns, "Cpu"}, nameplate).value();
///     const auto fast = add_ctrl_task(space, cpu, {ns, "Fast"}, {.priority = 1,
///                                     .interval = "T#1ms"}).value();
///     const auto main_type = add_program_type(space, {ns, "Main"}).value();
///     add_pou_variable(space, main_type, PouVariable::Input, {ns, "Start"}, start);
///     const auto main = add_program(space, cpu, {ns, "Main1"}, main_type, fast).value();
///
/// The nodes of PLCopen and DI must be in the AddressSpace: busbar::plcopen::nodes() or the
/// NodeSet2 files; Bad_TypeDefinitionInvalid if they are not, or if an argument is a node of
/// another type. Other errors and the NodeIds of created nodes are those of instance.hpp.
namespace busbar::model {

/// The namespace of PLCopen.
inline constexpr std::string_view plcopen_uri = "http://PLCopen.org/OpcUa/IEC61131-3/";

/// Numbers of nodes of PLCopen.
namespace plcopen_id {
inline constexpr std::uint32_t CtrlConfigurationType = 1001;
inline constexpr std::uint32_t CtrlResourceType = 1002;
inline constexpr std::uint32_t CtrlProgramOrganizationUnitType = 1003;
inline constexpr std::uint32_t CtrlProgramType = 1004;
inline constexpr std::uint32_t CtrlFunctionBlockType = 1005;
inline constexpr std::uint32_t CtrlTaskType = 1006;
inline constexpr std::uint32_t HasInputVar = 4001;
inline constexpr std::uint32_t HasOutputVar = 4002;
inline constexpr std::uint32_t HasInOutVar = 4003;
inline constexpr std::uint32_t HasLocalVar = 4004;
inline constexpr std::uint32_t HasExternalVar = 4005;
inline constexpr std::uint32_t With = 4006;
} // namespace plcopen_id

/// The section of a program organization unit that a Variable is declared in.
enum class PouVariable : std::uint32_t {
    Input = plcopen_id::HasInputVar,
    Output = plcopen_id::HasOutputVar,
    InOut = plcopen_id::HasInOutVar,
    Local = plcopen_id::HasLocalVar,
};

/// The Properties of a task (CtrlTaskType of PLCopen).
struct CtrlTask {
    std::uint32_t priority{0};
    /// The interval as IEC 61131-3 writes it, "T#10ms", and the trigger of a task that is run by an
    /// event. If null, the Property is left out.
    String interval;
    String single;
};

/// Returns the node of PLCopen with this number, no_node if there is none.
[[nodiscard]] BUSBAR_API NodeIndex find_plcopen(const SpaceReader& space, std::uint32_t number);

/// Adds the controller as a whole, a TopologyElement; without a parent in the DeviceSet.
BUSBAR_API Result<NodeIndex> add_ctrl_configuration(AddressSpace& space, NewNode node,
                                                    const InstanceOptions& options = {});
/// Adds a resource, which runs programs: a device below the configuration's Resources.
BUSBAR_API Result<NodeIndex> add_ctrl_resource(AddressSpace& space, NodeIndex configuration,
                                               const QualifiedName& name,
                                               const Nameplate& nameplate,
                                               const InstanceOptions& options = {});
/// Adds a task below the resource's Tasks.
BUSBAR_API Result<NodeIndex> add_ctrl_task(AddressSpace& space, NodeIndex resource,
                                           const QualifiedName& name, const CtrlTask& task);

/// Adds a type of programs or of function blocks, with a numeric NodeId.
BUSBAR_API Result<NodeIndex> add_program_type(AddressSpace& space, const QualifiedName& name);
BUSBAR_API Result<NodeIndex> add_function_block_type(AddressSpace& space,
                                                     const QualifiedName& name);

/// Declares a Variable of a program or function block. In a type it is Mandatory: instances that
/// are created later have it too.
BUSBAR_API Result<NodeIndex> add_pou_variable(AddressSpace& space, NodeIndex unit,
                                              PouVariable section, const QualifiedName& name,
                                              const NewVariable& variable);
/// Makes the unit use an existing global Variable.
BUSBAR_API Result<void> add_external_variable(AddressSpace& space, NodeIndex unit,
                                              NodeIndex global);

/// Adds a program below the resource's Programs; `task`, unless it is no_node, runs it.
BUSBAR_API Result<NodeIndex> add_program(AddressSpace& space, NodeIndex resource,
                                         const QualifiedName& name, NodeIndex type,
                                         NodeIndex task = no_node);
/// Adds a function block that is a local variable of a program or function block; Mandatory in a
/// type.
BUSBAR_API Result<NodeIndex> add_function_block(AddressSpace& space, NodeIndex unit,
                                                const QualifiedName& name, NodeIndex type);

/// Adds a Variable to the GlobalVars of a configuration or resource, which are created if
/// necessary.
BUSBAR_API Result<NodeIndex> add_global_variable(AddressSpace& space, NodeIndex owner,
                                                 const QualifiedName& name,
                                                 const NewVariable& variable);

} // namespace busbar::model
