#pragma once

#include <cstdint>
#include <utility>

#include <busbar/core/types.hpp>
#include <busbar/core/value_like.hpp>
#include <busbar/model/node.hpp>
#include <busbar/types/ids.hpp>

/// The arguments of AddressSpace::add_... The AddressSpace copies what it keeps, so that strings
/// may be borrowed.
namespace busbar::model {

/// The access of clients to the Value of a Variable: bits of AccessLevelType (Part 3, 8.57), which
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

/// The usual operators of sets of bits.
[[nodiscard]] constexpr Access operator|(Access a, Access b)
{
    return Access{static_cast<std::uint8_t>(static_cast<unsigned>(a) | static_cast<unsigned>(b))};
}
[[nodiscard]] constexpr Access operator&(Access a, Access b)
{
    return Access{static_cast<std::uint8_t>(static_cast<unsigned>(a) & static_cast<unsigned>(b))};
}

/// The attributes of every new node, of any NodeClass.
struct NewNode {
    /// If null, an unused numeric id in the BrowseName's namespace.
    NodeId id;
    QualifiedName browse_name;
    /// The source of the hierarchical reference to the new node; for a type, its supertype.
    NodeIndex parent{no_node};
    /// If null, HasSubtype for a type, HasComponent for a Method, for others Organizes below a
    /// folder or a View and else HasComponent.
    NodeId reference_type;
    /// A null text stands for the BrowseName.
    LocalizedText display_name;
    LocalizedText description;
};

/// The attributes of a Variable (Part 3, 5.6.2).
struct NewVariable {
    NodeId data_type{0, id::BaseDataType};
    std::int32_t value_rank{-1};
    Array<std::uint32_t> array_dimensions;
    Access access_level{Access::Read};
    /// Bits that `access_level` does not have are ignored.
    Access user_access_level{Access::All};
    /// Milliseconds; -1 for indeterminate (Part 3, 5.6.2).
    double minimum_sampling_interval{0};
    bool historizing{false};
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
    /// The value of a Variable without a source.
    Variant value;
    /// The default is BaseDataVariableType; add_property uses PropertyType.
    NodeId type_definition{0, id::BaseDataVariableType};
};

/// The Value of a new Variable and the source that serves it. A data source creates one
/// (server::DataSource::variable); if it is made of a value alone, the AddressSpace keeps it.
struct BoundValue {
    template <typename T>
    requires ValueLike<T> BoundValue(T of) : value{busbar::detail::variant_of(std::move(of))} {}
    BoundValue(Variant like, std::uint32_t of_source, std::uint64_t of_handle)
        : value{std::move(like)}, source{of_source}, handle{of_handle}
    {
    }

    /// Gives the Variable its DataType, ValueRank and ArrayDimensions: an array may become shorter,
    /// not longer, unless it is empty. A null value sets none of them.
    Variant value;
    /// If not null, the DataType, for example of an enumeration whose values are of type Int32.
    NodeId data_type;
    /// The same as in NewVariable.
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

/// The attributes of the other NodeClasses (Part 3, 5.3 to 5.8).
struct NewObject {
    NodeId type_definition{0, id::BaseObjectType};
    std::uint8_t event_notifier{0};
};
struct NewMethod {
    bool executable{true};
    /// The values of the properties InputArguments and OutputArguments (Part 3, 5.7.2); an empty
    /// list has no property.
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
