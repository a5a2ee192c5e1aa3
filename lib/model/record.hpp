#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/model/node.hpp>

#include "index_table.hpp"
#include "type_class.hpp"

namespace busbar::model::detail {

[[nodiscard]] constexpr std::uint32_t number(NodeIndex node)
{
    return static_cast<std::uint32_t>(node);
}

/// One reference in a node's list; a hole where one was removed.
struct Entry {
    NodeIndex target{no_node};
    /// The ReferenceType, bit 31 for inverse.
    std::uint32_t type_bits{0};

    static constexpr std::uint32_t inverse_bit = 1U << 31U;

    Entry() = default;
    Entry(NodeIndex type, NodeIndex to, bool is_forward)
        : target{to}, type_bits{number(type) | (is_forward ? 0 : inverse_bit)}
    {
    }
    [[nodiscard]] bool is_hole() const { return target == no_node; }
    [[nodiscard]] NodeIndex type() const { return NodeIndex{type_bits & ~inverse_bit}; }
    [[nodiscard]] bool is_forward() const { return (type_bits & inverse_bit) == 0; }
    friend bool operator==(const Entry&, const Entry&) = default;
};

/// The references of a node to its children and those of add_reference, in the order of addition.
struct ReferenceList {
    Array<Entry> entries;
    std::uint32_t holes{0};
    /// Number of references that are not to children whose parent is this node.
    std::uint32_t others{0};
    /// Finds the others in a long list; may be null.
    std::unique_ptr<IndexTable> index{};
};

/// The properties of a kept value in addition to the value itself.
struct ValueQuality {
    DateTime source_timestamp;
    StatusCode status;
    std::uint16_t source_picoseconds{0};
};

/// The data that few dynamic nodes have.
struct Extra {
    LocalizedText display_name;
    LocalizedText description;
    LocalizedText inverse_name;
    Array<std::uint32_t> array_dimensions;
    Variant value;
    ValueQuality quality;
    ExtensionObject definition;
    /// For a type: the dynamic types from the first one below a constant type down to itself.
    std::vector<NodeIndex> chain;
    /// For a type: the nearest constant supertype.
    NodeIndex constant_base{no_node};
};

/// The rest of a dynamic node: its name and its place.
struct NodeLinks {
    std::uint32_t name_offset{0};
    std::uint32_t name_size{0};
    NodeIndex parent{no_node};
    std::uint32_t parent_slot{0};
    NodeIndex parent_reference{no_node};
    NodeIndex type_definition{no_node};
    std::unique_ptr<ReferenceList> references;
};

/// A dynamic node: the data to find it by its NodeId and to read its Value, which fits in one cache
/// line. The text block has the identifier of a String or Opaque NodeId (the 16 bytes of a Guid)
/// and the BrowseName, which shares bytes with the identifier if that ends with it.
struct alignas(64) NodeRecord {
    std::uint32_t generation{0};
    std::uint16_t id_namespace{0};
    std::uint16_t browse_namespace{0};
    /// A NodeClass; 0 for a free record.
    std::uint8_t class_bits{0};
    IdType id_type{IdType::Numeric};
    std::uint8_t flags{0};
    std::uint8_t event_notifier{0};
    /// The numeric identifier, or the size of the identifier's text.
    std::uint32_t id{0};
    std::unique_ptr<char[]> text;
    std::uint64_t handle{0};
    double minimum_sampling_interval{0};
    std::uint32_t source{no_source};
    NodeIndex data_type{no_node};
    std::int32_t value_rank{-1};
    std::uint8_t access_level{0};
    std::uint8_t user_access_level{0};
    std::unique_ptr<Extra> extra;

    [[nodiscard]] bool is_free() const { return class_bits == 0; }
    [[nodiscard]] NodeClass node_class() const { return NodeClass{class_bits}; }
    /// Returns its BrowseName; borrowed.
    [[nodiscard]] std::string_view name(const NodeLinks& links) const
    {
        return {text.get() + links.name_offset, links.name_size};
    }
    /// Returns its identifier; borrowed.
    [[nodiscard]] NodeId node_id() const;
    /// Sets identifier and BrowseName. Both must be new.
    void set_names(const NodeId& id_of_node, const QualifiedName& browse_name, NodeLinks& links);
    [[nodiscard]] bool has_id(const NodeId& other) const;
    [[nodiscard]] BUSBAR_API Extra& make_extra();
};

static_assert(sizeof(NodeRecord) == 64);

/// Changes of a constant node at run time.
struct Overlay {
    ReferenceList references;
    Variant value;
    ValueQuality quality;
    LocalizedText display_name;
    LocalizedText description;
    std::uint64_t handle{0};
    std::uint32_t source{no_source};
    bool has_value{false};
    bool has_access_level{false};
    bool has_executable{false};
    bool executable{false};
    std::uint8_t access_level{0};
    std::uint8_t user_access_level{0};
};

/// The source timestamp of a value that was set without one: null for everybody, and different from
/// that of a value that came with its node and was never set.
inline constexpr DateTime no_time{-1};

} // namespace busbar::model::detail
