#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/core/built_in_type.hpp>
#include <busbar/core/detail/basic_ids.hpp>
#include <busbar/core/types.hpp>

#include "document.hpp"

namespace busbar::model {
class SpaceReader;
}

namespace busbar::nodeset {

namespace basic_id = busbar::detail::basic_id;

/// NodeIds of the ReferenceTypes.
inline constexpr std::uint32_t has_subtype = basic_id::HasSubtype;
inline constexpr std::uint32_t has_type_definition = basic_id::HasTypeDefinition;

/// The encoding of a DataType: a built-in type by its id, or one of the kinds after them.
enum class Kind : std::uint8_t {
    Unknown = 0,
    // 1 to 25: BuiltInType
    Structure = 22,
    Variant = 24,
    Enumeration = 29,
    OptionSetStructure = 100,
    Union = 101,
};

/// The structure of values of a DataType.
struct DataType {
    NodeId id;
    std::uint16_t name_space{0};
    std::string name;
    NodeId supertype;
    NodeId binary_encoding;
    NodeId xml_encoding;
    bool is_abstract{false};
    /// The fields include those of the supertypes.
    bool is_complete{false};
    std::optional<Definition> definition;
};

/// The encoding of a field, or of an element of it.
struct FieldForm {
    enum class Class : std::uint8_t { Unknown, BuiltIn, Enumeration, Structure };

    Class form{Class::Unknown};
    BuiltInType built_in{BuiltInType::Null};
    const DataType* structure{nullptr};
};

/// The DataTypes of a Document, and others that are known from elsewhere.
class DataTypeTable {
public:
    DataTypeTable() = default;
    explicit DataTypeTable(const Document& document);

    /// Adds a DataType from elsewhere; a known one stays.
    void add(DataType type);
    /// Sets the encoding of values of `type`, also for XML.
    void add_encoding(const NodeId& type, const NodeId& encoding);

    [[nodiscard]] const DataType* find(const NodeId& id) const;
    /// Returns the DataType whose encoding, or whose own id, this is.
    [[nodiscard]] const DataType* find_encoded(const NodeId& encoding) const;
    /// Finds by BrowseName or SymbolicName, if nothing better identifies it.
    [[nodiscard]] const DataType* find_named(std::uint16_t name_space, std::string_view name) const;
    [[nodiscard]] const DataType* supertype(const NodeId& id) const;
    /// Resolved along HasSubtype (Part 6, 5.1.2).
    [[nodiscard]] Kind kind(const NodeId& id) const;
    /// The binary encoding; null if there is none.
    [[nodiscard]] NodeId binary_encoding(const NodeId& id) const;
    /// For a structure including the supertypes' fields, which come first (Part 3, 8.48); for
    /// others only its own.
    [[nodiscard]] std::vector<const Field*> fields(const NodeId& id) const;
    [[nodiscard]] FieldForm form(const Field& field) const;
    /// True for a structure whose Definition is a Union, or that is below Union.
    [[nodiscard]] bool is_union(const NodeId& id) const;
    /// True for Structure, Union and OptionSet themselves, which stand for any subtype.
    [[nodiscard]] static bool is_open_structure(const NodeId& id);

    /// Maximum number of levels of supertypes.
    static constexpr unsigned max_levels = 100;

private:
    void insert(DataType type);
    void add_references(const Document& document, const Node& node);
    void add_xml_names(const Node& node);

    std::unordered_map<NodeId, DataType> types_;
    std::unordered_map<NodeId, NodeId> encoded_;
    std::unordered_map<std::string, NodeId> names_;
};

/// The DataTypeDefinition attribute of a DataType (Part 3, 5.8.3): a StructureDefinition or an
/// EnumDefinition with a binary body; null if the DataType has none.
[[nodiscard]] ExtensionObject definition_of(const DataTypeTable& types, const DataType& type);

/// Adds the DataTypes of an AddressSpace by their attributes and references.
void add_data_types(const model::SpaceReader& space, DataTypeTable& types);

/// Returns the Definition for a DataTypeDefinition attribute, with the fields of supertypes.
[[nodiscard]] std::optional<Definition> definition_from(const ExtensionObject& attribute);

} // namespace busbar::nodeset
