#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/built_in_type.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/data_types.hpp>

/// Types that are known from their DataTypeDefinition only (Part 3, 5.8.3 and 8.47 to 8.52). For
/// their values see dynamic_value.hpp. A server's are collected by model::DataTypes; a client fills
/// DataTypeEntries from what it reads.
namespace busbar::binary {

/// What the attributes and references of one DataType node say.
struct DataTypeEntry {
    NodeId id;
    /// The BrowseName without its namespace.
    String name;
    /// The source of HasSubtype. Null: the base_data_type of the StructureDefinition.
    NodeId base;
    /// "Default Binary". Null: the default_encoding_id of the StructureDefinition.
    NodeId encoding_id;
    bool is_abstract{false};
    /// None for simple types such as Duration, and for abstract types.
    std::variant<std::monostate, StructureDefinition, EnumDefinition> definition;
};

/// The DataTypes of OPC UA itself that this build has, with their definitions. They take about half
/// a megabyte.
[[nodiscard]] BUSBAR_API std::vector<DataTypeEntry> namespace0_data_types();

/// Limits of definitions, which may come from a hostile server. All are finite.
struct DynamicTypeLimits {
    std::size_t max_types{65'536};
    /// Of one structure.
    std::size_t max_fields{1'000};
    /// Names of one enumeration or option set.
    std::size_t max_values{10'000};
    /// Bytes of the name of a type, a field or an enumeration's value.
    std::size_t max_name_length{512};
    std::size_t max_rank{16};
    /// Supertypes above a type, and structures directly within one another.
    std::size_t max_depth{100};
    /// Fields of a structure with those of the structures directly in it, at any depth, so that a
    /// few definitions that contain each other twice cannot describe a value of gigabytes.
    std::size_t max_nested_fields{10'000};
};

/// Why a definition cannot be used: Bad_DataTypeIdUnknown for a type that is missing,
/// Bad_EncodingLimitsExceeded for one that is larger than the limits, else
/// Bad_NodeAttributesInvalid.
struct DefinitionError {
    StatusCode status;
    NodeId type;
    std::string type_name;
    /// Empty if it is about the type itself.
    std::string field;
    std::string reason;
};

/// "ns=2;i=7 (Point), field X: its DataType ns=2;i=9 is not known"; printable.
[[nodiscard]] BUSBAR_API std::string to_string(const DefinitionError& error);

struct DynamicType;

/// One field of a structure or union (Part 3, 8.51) and how its values lie on the wire.
struct DynamicField {
    std::string name;
    NodeId data_type;
    /// The type named by `data_type`; null for a built-in type.
    const DynamicType* type{nullptr};
    /// Of a value or element. ExtensionObject and Variant also stand for what may be a subtype.
    BuiltInType built_in{BuiltInType::Null};
    /// The bits (by BuiltInType) that a Variant in this field may hold; null is always allowed.
    std::uint32_t variant_types{UINT32_MAX};
    /// -1 for a scalar, else the number of dimensions.
    std::int32_t value_rank{-1};
    /// The greatest length of each dimension, 0 for any; empty if every array fits. Checked only of
    /// what clients write: a decoder takes what a server sends.
    std::vector<std::uint32_t> array_dimensions;
    /// The most bytes of each String, ByteString or text of a LocalizedText, 0 for any. Checked as
    /// above.
    std::uint32_t max_string_length{0};
    /// The value is a structure or union of `type` and lies there without ExtensionObject.
    bool is_structure{false};
    /// Has a bit in the EncodingMask (Part 6, 5.2.7).
    bool is_optional{false};
    bool allows_subtypes{false};

    [[nodiscard]] bool is_scalar() const { return value_rank < 1; }
    [[nodiscard]] bool is_matrix() const { return value_rank > 1; }
};

/// A compiled DataType. Made by DynamicTypes only, never changed.
struct BUSBAR_API DynamicType {
    enum class Kind : std::uint8_t { Simple, Enumeration, OptionSet, Structure, Union };
    /// A value of an enumeration, or the number of an option set's bit.
    struct Value {
        std::int64_t value{0};
        std::string name;
    };

    NodeId id;
    std::string name;
    /// Null for a type that is abstract or only used within others.
    NodeId encoding_id;
    /// The supertype if it is known.
    const DynamicType* base{nullptr};
    Kind kind{Kind::Simple};
    /// Int32 for an enumeration, an unsigned integer for an option set, ExtensionObject for a
    /// structure, Variant for an abstract number.
    BuiltInType built_in{BuiltInType::Null};
    bool is_abstract{false};
    /// Values begin with an EncodingMask.
    bool has_optional_fields{false};
    /// Those of the supertypes come first (Part 3, 8.48).
    std::vector<DynamicField> fields;
    std::vector<Value> values;
    /// The fewest bytes of a value on the wire.
    std::size_t min_wire_size{0};

    [[nodiscard]] bool is_structure() const
    {
        return kind == Kind::Structure || kind == Kind::Union;
    }
    /// The index of the field of that name.
    [[nodiscard]] std::optional<std::size_t> find_field(std::string_view field_name) const;
    /// True for the type itself as well.
    [[nodiscard]] bool is_subtype_of(const DynamicType& other) const;
};

/// A set of types, resolved once. Movable; DynamicType objects stay where they are and live as long
/// as the set. Any thread may read it.
class BUSBAR_API DynamicTypes {
public:
    DynamicTypes() = default;

    /// Resolves entries, in whatever order they come. A definition that is wrong is left out, with
    /// all that need it, and reported by errors(); the others can be used.
    [[nodiscard]] static DynamicTypes compile(std::vector<DataTypeEntry> entries,
                                              const DynamicTypeLimits& limits = {});

    /// What was left out; empty if all is well.
    [[nodiscard]] std::span<const DefinitionError> errors() const { return errors_; }
    /// The type of that DataType NodeId; null if there is none.
    [[nodiscard]] const DynamicType* find(const NodeId& data_type) const;
    /// The structure whose values an ExtensionObject of this encoding has; null if there is none.
    [[nodiscard]] const DynamicType* find_encoding(const NodeId& encoding_id) const;
    /// How many types can be used.
    [[nodiscard]] std::size_t size() const { return by_id_.size(); }

private:
    std::vector<std::unique_ptr<const DynamicType>> types_;
    std::unordered_map<NodeId, const DynamicType*> by_id_;
    std::unordered_map<NodeId, const DynamicType*> by_encoding_;
    std::vector<DefinitionError> errors_;
};

} // namespace busbar::binary
