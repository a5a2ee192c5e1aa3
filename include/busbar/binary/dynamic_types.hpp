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
/// their values see dynamic_value.hpp. model::DataTypes collects those of a server; a client fills
/// DataTypeEntries from what it reads.
namespace busbar::binary {

/// The attributes and references of one DataType node.
struct DataTypeEntry {
    NodeId id;
    /// The BrowseName without its namespace.
    String name;
    /// The source of HasSubtype. If null, the base_data_type of the StructureDefinition counts.
    NodeId base;
    /// The id of "Default Binary". If null, the default_encoding_id of the StructureDefinition
    /// counts.
    NodeId encoding_id;
    bool is_abstract{false};
    /// Empty for simple types such as Duration, and for abstract types.
    std::variant<std::monostate, StructureDefinition, EnumDefinition> definition;
};

/// The DataTypes of OPC UA itself that this build has, with their definitions. They take about half
/// a megabyte.
[[nodiscard]] BUSBAR_API std::vector<DataTypeEntry> namespace0_data_types();

/// Limits of definitions, which may come from a hostile server. All are finite.
struct DynamicTypeLimits {
    std::size_t max_types{65'536};
    /// Fields of one structure.
    std::size_t max_fields{1'000};
    /// Names of one enumeration or option set.
    std::size_t max_values{10'000};
    /// Bytes of the name of a type, a field or an enumeration's value.
    std::size_t max_name_length{512};
    std::size_t max_rank{16};
    /// Levels of supertypes above a type, and of structures directly within one another.
    std::size_t max_depth{100};
    /// Fields of a structure including those of the structures directly in it, at any depth, so
    /// that a few definitions that contain each other twice cannot describe a value of gigabytes.
    std::size_t max_nested_fields{10'000};
};

/// The reason why a definition cannot be used: Bad_DataTypeIdUnknown for a missing type,
/// Bad_EncodingLimitsExceeded for one that exceeds the limits, else Bad_NodeAttributesInvalid.
struct DefinitionError {
    StatusCode status;
    NodeId type;
    std::string type_name;
    /// Empty if the type itself is wrong.
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
    /// The type that `data_type` names; null for a built-in type.
    const DynamicType* type{nullptr};
    /// The type of a value or element. ExtensionObject and Variant also stand for values that may
    /// be of a subtype.
    BuiltInType built_in{BuiltInType::Null};
    /// The bits (by BuiltInType) that a Variant in this field may hold; null is always allowed.
    std::uint32_t variant_types{UINT32_MAX};
    /// -1 for a scalar, else the number of dimensions.
    std::int32_t value_rank{-1};
    /// The maximum length of each dimension, 0 for no limit; empty if every array fits. Checked
    /// only for values that clients write: a decoder accepts what a server sends.
    std::vector<std::uint32_t> array_dimensions;
    /// The maximum number of bytes of each String, ByteString or text of a LocalizedText, 0 for no
    /// limit. Checked as above.
    std::uint32_t max_string_length{0};
    /// The value is a structure or union of `type` and is encoded without ExtensionObject.
    bool is_structure{false};
    /// The field has a bit in the EncodingMask (Part 6, 5.2.7).
    bool is_optional{false};
    bool allows_subtypes{false};

    [[nodiscard]] bool is_scalar() const { return value_rank < 1; }
    [[nodiscard]] bool is_matrix() const { return value_rank > 1; }
};

/// A compiled DataType. Created by DynamicTypes only and never changed.
struct BUSBAR_API DynamicType {
    /// Simple stands for a built-in type or a type derived from one.
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
    /// A value begins with an EncodingMask.
    bool has_optional_fields{false};
    /// All fields; those of the supertypes come first (Part 3, 8.48).
    std::vector<DynamicField> fields;
    std::vector<Value> values;
    /// The minimum number of bytes of a value on the wire.
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

/// A set of types, resolved once. Movable; DynamicType objects keep their address and live as long
/// as the set. Any thread may read it.
class BUSBAR_API DynamicTypes {
public:
    DynamicTypes() = default;

    /// Resolves entries in any order. A wrong definition is left out together with all that depend
    /// on it, and reported by errors(); the others can be used.
    [[nodiscard]] static DynamicTypes compile(std::vector<DataTypeEntry> entries,
                                              const DynamicTypeLimits& limits = {});

    /// The definitions that were left out; empty if all are right.
    [[nodiscard]] std::span<const DefinitionError> errors() const { return errors_; }
    /// The type of that DataType NodeId; null if there is none.
    [[nodiscard]] const DynamicType* find(const NodeId& data_type) const;
    /// The structure type with this encoding id; null if there is none.
    [[nodiscard]] const DynamicType* find_encoding(const NodeId& encoding_id) const;
    /// The number of types that can be used.
    [[nodiscard]] std::size_t size() const { return by_id_.size(); }

private:
    std::vector<std::unique_ptr<const DynamicType>> types_;
    std::unordered_map<NodeId, const DynamicType*> by_id_;
    std::unordered_map<NodeId, const DynamicType*> by_encoding_;
    std::vector<DefinitionError> errors_;
};

} // namespace busbar::binary
