#pragma once

#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/model/instance.hpp>

/// Devices of OPC UA for Devices (Part 100): Objects with a nameplate in the DeviceSet.
///
///     space.add(busbar::di::nodes());          // or the NodeSet2 file
///     Nameplate nameplate;
///     nameplate.manufacturer = LocalizedText{"Acme"};
///     nameplate.serial_number = "4711";
///     add_device(space, press, press_type, nameplate);
///
/// All functions return Bad_TypeDefinitionInvalid if the AddressSpace has no nodes of DI; other
/// errors and the NodeIds of created nodes are those of instance.hpp.
namespace busbar::model {

/// The namespace of DI.
inline constexpr std::string_view di_uri = "http://opcfoundation.org/UA/DI/";

/// Numbers of nodes of DI.
namespace di_id {
inline constexpr std::uint32_t TopologyElementType = 1001;
inline constexpr std::uint32_t DeviceType = 1002;
inline constexpr std::uint32_t FunctionalGroupType = 1005;
inline constexpr std::uint32_t DeviceSet = 5001;
} // namespace di_id

/// The Properties of a DeviceType (Part 100, 4.5.2). Those up to revision_counter always exist; the
/// others if their text is not null.
struct Nameplate {
    LocalizedText manufacturer;
    LocalizedText model;
    String hardware_revision;
    String software_revision;
    String device_revision;
    /// The location of the manual, a path or an URL.
    String device_manual;
    String serial_number;
    /// Number of changes of the device's configuration; -1 if they are not counted.
    std::int32_t revision_counter{-1};
    String manufacturer_uri;
    String product_code;
    String product_instance_uri;
    String device_class;
};

/// Returns the node of DI with this number, no_node if there is none.
[[nodiscard]] BUSBAR_API NodeIndex find_di(const SpaceReader& space, std::uint32_t number);

/// Creates a device of `type`, a concrete subtype of DeviceType. Without a parent it is added to
/// the DeviceSet.
BUSBAR_API Result<NodeIndex> add_device(AddressSpace& space, NewNode node, NodeIndex type,
                                        const Nameplate& nameplate, InstanceOptions options = {});

/// Creates a FunctionalGroup below a device or another group (Part 100, 4.4).
BUSBAR_API Result<NodeIndex> add_functional_group(AddressSpace& space, NodeIndex parent,
                                                  const QualifiedName& name);

/// Creates a parameter in the device's ParameterSet, which is created if necessary. `group`, unless
/// it is no_node, organizes it (Part 100, 4.3).
BUSBAR_API Result<NodeIndex> add_parameter(AddressSpace& space, NodeIndex device, NodeIndex group,
                                           const QualifiedName& name, const NewVariable& variable);

} // namespace busbar::model
