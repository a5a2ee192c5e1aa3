#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

/// The nodes of one namespace as constant data, as busbar-generate writes them.
///
/// The tables contain no pointers, so that they are in read-only memory and cost no time at start.
/// Nodes, texts and values are named by index or offset. The nodes that are types come first, each
/// directly before its subtypes: the subtypes of a type are one interval.
namespace busbar::model {

/// A piece of StaticNodes::text, or of another table.
struct StaticText {
    std::uint32_t offset{0};
    std::uint32_t size{0};
};

/// The meaning of StaticIdentifier::value.
enum class StaticIdKind : std::uint8_t { Numeric, Text };

/// A NodeId: a number, or the index of the entry of `texts` that NodeId::parse reads, without
/// namespace.
struct StaticIdentifier {
    std::uint32_t value{0};
    std::uint16_t namespace_index{0};
    StaticIdKind kind{StaticIdKind::Numeric};
};

namespace static_flag {
inline constexpr std::uint8_t is_abstract = 1;
inline constexpr std::uint8_t symmetric = 2;
inline constexpr std::uint8_t contains_no_loops = 4;
inline constexpr std::uint8_t executable = 8;
inline constexpr std::uint8_t historizing = 16;
} // namespace static_flag

struct StaticNode {
    StaticIdentifier id;
    StaticText browse_name;
    /// Index in `references`; those of a node end where those of the next one begin.
    std::uint32_t first_reference{0};
    /// For a Variable or VariableType the index of its entry in `variables`; for a ReferenceType
    /// the entry of `texts` with its InverseName, for a DataType the entry of `texts` that locates
    /// its DataTypeDefinition in `values`; no_details if it has none.
    std::uint32_t details{0};
    std::uint16_t browse_namespace{0};
    /// The value of NodeClass.
    std::uint8_t node_class{0};
    std::uint8_t flags{0};
    std::uint8_t event_notifier{0};
};

/// The index of details that a node does not have.
inline constexpr std::uint32_t no_details = UINT32_MAX;

/// The attributes of a Variable or a VariableType.
struct StaticVariable {
    /// Index of a node, or past the last node of an entry of `externals`.
    std::uint32_t data_type{0};
    std::int32_t value_rank{-1};
    /// A range of `dimensions`.
    StaticText array_dimensions;
    /// A range of `values`: an encoded Variant; empty if there is none.
    StaticText value;
    double minimum_sampling_interval{0};
    std::uint8_t access_level{0};
};

/// A text that most nodes do not have.
struct StaticExtra {
    /// The attribute, or the locale of one.
    enum class Kind : std::uint32_t {
        DisplayName,
        Description,
        DisplayNameLocale,
        DescriptionLocale,
        InverseNameLocale,
    };

    std::uint32_t node{0};
    Kind kind{Kind::DisplayName};
    StaticText text;
};

/// NodeAccess of the few nodes that have any of it.
struct StaticAccess {
    std::uint32_t node{0};
    std::uint32_t write_mask{0};
    std::uint32_t more_access_levels{0};
    std::uint16_t restrictions{0};
    bool has_restrictions{false};
    /// A range of `values`: an encoded Variant with an array of RolePermissionType; empty if there
    /// is none.
    StaticText role_permissions;
};

/// A reference in 32 bits: the target in bits 0-22 (a node, or past the last node an entry of
/// `externals`), the type as an index of `reference_types` in bits 23-30, bit 31 for inverse.
class StaticReference {
public:
    static constexpr std::uint32_t max_target = (1U << 23U) - 1;
    static constexpr std::uint32_t max_type = 255;

    constexpr StaticReference() = default;
    constexpr StaticReference(std::uint32_t type, std::uint32_t target, bool is_forward)
        : bits_{target | type << 23U | (is_forward ? 0U : 1U << 31U)}
    {
    }
    constexpr explicit StaticReference(std::uint32_t bits) : bits_{bits} {}

    [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }
    [[nodiscard]] constexpr std::uint32_t target() const { return bits_ & max_target; }
    [[nodiscard]] constexpr std::uint32_t type() const { return bits_ >> 23U & max_type; }
    [[nodiscard]] constexpr bool is_forward() const { return bits_ >> 31U == 0; }

private:
    std::uint32_t bits_{0};
};

/// Describes a type: nodes [own index, last] are the type and its subtypes.
struct StaticType {
    std::uint32_t last{0};
    /// For a DataType the id of its built-in type; 26, 27 and 28 for Number, Integer, UInteger.
    std::uint8_t built_in{0};
};

/// All tables that were generated for one namespace. The spans are of constant data.
struct StaticNodes {
    /// Index 0 is that of OPC UA itself; other indices in these tables refer to this list.
    std::span<const StaticText> namespaces;
    std::span<const StaticNode> nodes;
    /// The first nodes, which are types.
    std::span<const StaticType> types;
    std::span<const StaticVariable> variables;
    std::span<const StaticReference> references;
    /// Nodes or externals, as reference targets.
    std::span<const std::uint32_t> reference_types;
    std::span<const StaticIdentifier> externals;
    /// Pieces of `text` or `values`.
    std::span<const StaticText> texts;
    /// Sorted by node and kind.
    std::span<const StaticExtra> extras;
    std::span<const std::uint32_t> dimensions;
    std::string_view text;
    std::string_view values;
    /// A hash table with open addressing by static_slot of the numeric ids in namespace 0: node
    /// index + 1, 0 for a free slot. The size is a power of two; empty for a namespace whose nodes
    /// are copied.
    std::span<const std::uint16_t> slots;
    std::span<const StaticAccess> access{};
    /// The AccessRestrictions of nodes of this namespace that have none of their own.
    std::uint16_t restrictions{0};
};

/// Returns the slot where the search for a numeric id begins.
[[nodiscard]] constexpr std::size_t static_slot(std::uint32_t id, std::size_t slot_count)
{
    const std::uint32_t mixed = id * 2'654'435'769U;
    return (mixed ^ mixed >> 15U) & (slot_count - 1);
}

} // namespace busbar::model
