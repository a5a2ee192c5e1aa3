#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <busbar/core/types.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model {

/// Names a node of an AddressSpace while that node exists; the index may then be given to another
/// node. For anything that is kept longer than a call there is NodeHandle.
enum class NodeIndex : std::uint32_t {};
inline constexpr NodeIndex no_node{UINT32_MAX};

/// Names a node for ever: after its removal the handle leads to no node.
struct NodeHandle {
    NodeIndex index{no_node};
    std::uint32_t generation{0};

    friend bool operator==(const NodeHandle&, const NodeHandle&) = default;
};

/// One reference as seen from the node it belongs to.
struct Reference {
    NodeIndex type{no_node};
    NodeIndex target{no_node};
    bool is_forward{true};
};

/// What clients may do with the Value of a Variable: bits of AccessLevelType (Part 3, 8.57), which
/// | joins. `Access{bits}` has those of a Byte.
enum class Access : std::uint8_t {
    None = 0,
    Read = 1,
    Write = 2,
    ReadWrite = Read | Write,
    HistoryRead = 4,
    HistoryWrite = 8,
    SemanticChange = 16,
    StatusWrite = 32,
    TimestampWrite = 64,
    All = 0xFF,
};

[[nodiscard]] constexpr Access operator|(Access a, Access b)
{
    return Access{static_cast<std::uint8_t>(static_cast<unsigned>(a) | static_cast<unsigned>(b))};
}
[[nodiscard]] constexpr Access operator&(Access a, Access b)
{
    return Access{static_cast<std::uint8_t>(static_cast<unsigned>(a) & static_cast<unsigned>(b))};
}

/// The source of a Variable whose value lies in the AddressSpace itself.
inline constexpr std::uint32_t no_source = UINT32_MAX;

/// What services need of a Variable or VariableType; the span is valid until the node changes.
struct VariableAttributes {
    NodeIndex data_type{no_node};
    std::int32_t value_rank{-1};
    std::span<const std::uint32_t> array_dimensions;
    double minimum_sampling_interval{0};
    /// Bits of AccessLevelType; 0 for a VariableType.
    std::uint8_t access_level{0};
    std::uint8_t user_access_level{0};
    bool historizing{false};
    /// The data source's index in the server, and the source's own handle of the value.
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

/// What services need of a Method.
struct MethodAttributes {
    /// The Executable attribute.
    bool executable{false};
    /// Who carries it out, as VariableAttributes::source.
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

/// Attributes that few nodes have (Part 3, 5.2.7 to 5.2.11 and 8.58). NodeSet2 files have them.
struct NodeAccess {
    /// WriteMask. No service writes any attribute but Value: UserWriteMask is always 0.
    std::uint32_t write_mask{0};
    /// The bits of AccessLevelEx above those of AccessLevel.
    std::uint32_t more_access_levels{0};
    /// Bits of AccessRestrictionType. Nothing: those of the node's namespace count.
    std::optional<std::uint16_t> restrictions{};
    /// Null if the node has none of its own; empty if nobody may do anything.
    Array<RolePermissionType> role_permissions{};

    friend bool operator==(const NodeAccess&, const NodeAccess&) = default;
};

/// What every new node has. Strings may be borrowed: the AddressSpace copies what it keeps.
struct NewNode {
    /// Null: a numeric id that is free in the BrowseName's namespace.
    NodeId id;
    QualifiedName browse_name;
    /// The source of the hierarchical reference to the new node. Of a type: its supertype.
    NodeIndex parent{no_node};
    /// Null: HasSubtype for a type, HasComponent for a Method, for others Organizes below a folder
    /// or a View and else HasComponent.
    NodeId reference_type;
    /// A null text stands for the BrowseName.
    LocalizedText display_name;
    LocalizedText description;
};

struct NewVariable {
    NodeId data_type{0, id::BaseDataType};
    std::int32_t value_rank{-1};
    Array<std::uint32_t> array_dimensions;
    Access access_level{Access::Read};
    /// Only the bits that `access_level` has count.
    Access user_access_level{Access::All};
    /// Milliseconds; -1 for indeterminate (Part 3, 5.6.2).
    double minimum_sampling_interval{0};
    bool historizing{false};
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
    /// The value, of a variable without source.
    Variant value;
    /// BaseDataVariableType; add_property has PropertyType.
    NodeId type_definition{0, id::BaseDataVariableType};
};

struct NewObject {
    NodeId type_definition{0, id::BaseObjectType};
    std::uint8_t event_notifier{0};
};

struct NewMethod {
    bool executable{true};
    /// What the properties InputArguments and OutputArguments say (Part 3, 5.7.2); there is none
    /// for a list that is empty.
    Array<Argument> input_arguments;
    Array<Argument> output_arguments;
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

struct NewVariableType {
    NodeId data_type{0, id::BaseDataType};
    std::int32_t value_rank{-2};
    Array<std::uint32_t> array_dimensions;
    Variant value;
    bool is_abstract{false};
};

struct NewReferenceType {
    LocalizedText inverse_name;
    bool is_abstract{false};
    bool symmetric{false};
};

struct NewDataType {
    /// A StructureDefinition or EnumDefinition; null if there is none.
    ExtensionObject definition;
    bool is_abstract{false};
};

} // namespace busbar::model
