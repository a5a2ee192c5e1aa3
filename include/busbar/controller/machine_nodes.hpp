#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/publishing.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/model/device.hpp>

/// The nodes of a controller that publishes its variables (W588, 6-2-1).
namespace busbar::controller {

/// The mode that clients see; see MachineMode.
enum class OperatingMode : std::uint8_t { Program, Run };
/// ContinuousError: a partial or minor fault.
enum class ErrorState : std::uint8_t { NoError, MajorFault, ContinuousError };

/// "PROGRAM", "RUN".
[[nodiscard]] BUSBAR_API std::string_view name(OperatingMode mode);
/// "NoError", "MajorFault", "ContinuousError".
[[nodiscard]] BUSBAR_API std::string_view name(ErrorState state);

/// Names and types of the nodes that a controller has.
struct MachineNodesOptions {
    std::string namespace_uri{"urn:busbar:machine"};
    /// The name of the folder below Objects and of the configuration of PLCopen.
    std::string controller_name{"Controller"};
    MachineTypeOptions types{};
    /// The index that the server gave to the data source of the variables.
    std::uint32_t source{0};
    /// The task's cycle, which is the shortest sampling interval for clients.
    Duration cycle{std::chrono::milliseconds{20}};
    /// Whether clients may subscribe to events of the folder.
    bool has_events{false};
    // Describes the runtime, the resource of PLCopen.
    std::string resource_name{"CPU"};
    model::Nameplate nameplate{};
};

/// The nodes of a controller, in the namespace of its program:
///
///     Objects/<controller name>      "Controller/"
///         DeviceState                "Controller/DeviceState"
///             ErrorState             "Controller/DeviceState/ErrorState", and so on
///             Mode
///             UnpublishedVariablesStatus
///             NumberOfPublishedVariables
///             NumberOfValueAttributes
///         GlobalVars                 "Controller/GlobalVars"
///             <variables>            their names
///
/// ErrorState and Mode are Strings: the manual has texts for their values, but not the numbers that
/// an enumeration would need. UnpublishedVariablesStatus is a UInt16, both numbers are UInt32.
/// Until they are set, Mode is PROGRAM and ErrorState NoError. GlobalVars has a NodeVersion, so
/// that clients can be notified of added variables.
///
/// A variable's handle is its position in Publication::published(), unless add_variables is called
/// with another one. Clients may write it unless it is CONSTANT.
///
/// If the AddressSpace has the nodes of DI and PLCopen, the DeviceSet has a configuration of
/// PLCopen with the controller's name ("PLCopen/Configuration") with GlobalVars, which organizes
/// the same variables, and a resource with nameplate, tasks and programs.
///
/// For the thread that changes the AddressSpace, which is passed to every call and may have been
/// moved in between.
class BUSBAR_API MachineNodes {
public:
    /// Uses the tasks and programs of `program`. The problem's `where` is "variables (Speed)",
    /// "types[3] (Point)", "tasks[1] (Fast)" or "instances[0] (Main)"; nodes that were added before
    /// stay.
    [[nodiscard]] static Configured<MachineNodes> create(model::AddressSpace& space,
                                                         const Program& program,
                                                         const Publication& publication,
                                                         const MachineNodesOptions& options);

    /// Adds the variables published since; `publication` is the one that the object was created
    /// with. After a failure none of them is added. `handles` are those of all published variables
    /// (PublishedProgram::handles); if empty, each handle is the variable's position.
    [[nodiscard]] Configured<void> add_variables(model::AddressSpace& space,
                                                 const Publication& publication,
                                                 std::span<const std::uint32_t> handles = {});

    /// Removes nodes of variables by their names; monitored items on them report Bad_NodeIdUnknown.
    /// DataTypes stay. Call add_variables after it.
    void remove_variables(model::AddressSpace& space, std::span<const std::string> names);

    /// Shows this mode to clients.
    void set_mode(model::AddressSpace& space, OperatingMode mode) const;
    /// Shows this state to clients.
    void set_error_state(model::AddressSpace& space, ErrorState state) const;
    /// Sets the status and both numbers; add_variables and create do this themselves.
    void set_publication(model::AddressSpace& space, const Publication& publication) const;

    [[nodiscard]] std::uint16_t namespace_index() const { return namespace_index_; }
    [[nodiscard]] model::NodeHandle folder() const { return folder_; }
    [[nodiscard]] model::NodeHandle device_state() const { return device_state_; }
    [[nodiscard]] model::NodeHandle global_vars() const { return global_vars_; }
    /// For code that creates values of the variables.
    [[nodiscard]] const MachineTypes& types() const { return types_; }

private:
    struct Properties {
        model::NodeHandle error_state;
        model::NodeHandle mode;
        model::NodeHandle status;
        model::NodeHandle variables;
        model::NodeHandle values;
    };

    MachineNodes(const model::SpaceReader& space, std::uint16_t namespace_index,
                 const MachineNodesOptions& options);

    [[nodiscard]] Result<void> add_frame(model::AddressSpace& space,
                                         const MachineNodesOptions& options);
    [[nodiscard]] Result<void> add_properties(model::AddressSpace& space);
    [[nodiscard]] Result<void> add_version(model::AddressSpace& space) const;
    [[nodiscard]] Result<model::NodeIndex> add_variable(model::AddressSpace& space,
                                                        const PublishedVariable& variable,
                                                        std::size_t handle) const;
    [[nodiscard]] Result<void> organize(model::AddressSpace& space,
                                        model::NodeIndex variable) const;

    std::uint16_t namespace_index_{0};
    std::uint32_t source_{0};
    Duration cycle_{};
    MachineTypes types_;
    model::NodeHandle folder_;
    model::NodeHandle device_state_;
    model::NodeHandle global_vars_;
    /// The PLCopen node; no_node without PLCopen.
    model::NodeHandle plcopen_vars_;
    Properties properties_;
    /// The number of published variables that have nodes.
    std::size_t added_{0};
};

} // namespace busbar::controller
