#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::model {

/// Limits of NodeSet2 files, which come from users.
///
/// Loading takes 2.5 to 3 kB of memory for each node of the files, most of which is free again
/// afterwards: half a gigabyte for a file of 64 MB. For larger ones see limits_for_large_models.
struct NodeSetLimits {
    std::size_t max_file_size{64U << 20U};
    std::size_t max_nodes{1'000'000};
    std::size_t max_references{8'000'000};
    std::size_t max_aliases{100'000};
    /// Applies also to models, and to required models.
    std::size_t max_namespaces{1'000};
    std::size_t max_fields{4'096};
    /// Locales of one DisplayName, Description or InverseName.
    std::size_t max_locales{100};
    /// Levels of elements in a `<Value>`.
    std::size_t max_value_depth{64};
    /// Elements below all `<Value>`s of a file.
    std::size_t max_value_elements{4'000'000};
    /// Fields of the structures in all values, including those that a file leaves out.
    std::size_t max_value_fields{4'000'000};
    /// Bytes of XML that are kept unchanged: `<Extensions>`, XmlElements and the like.
    std::size_t max_kept_xml{64U << 20U};
    /// Levels of HasSubtype above a type.
    std::size_t max_type_levels{100};
    /// Maximum number of errors, and of notes, that one load reports.
    std::size_t max_errors{100};
    /// Accepts a RequiredModel in an older version than the required one.
    bool accepts_older_models{false};
};

/// Limits for files that may be large, such as the variables of a plant: four million nodes, 1 GB a
/// file. A million Variables are 350 MB of XML and take 2.7 GB while they are loaded.
[[nodiscard]] constexpr NodeSetLimits limits_for_large_models()
{
    NodeSetLimits limits;
    limits.max_file_size = std::size_t{1} << 30U;
    limits.max_nodes = 4'000'000;
    limits.max_references = 32'000'000;
    limits.max_value_elements = 32'000'000;
    limits.max_value_fields = 32'000'000;
    limits.max_kept_xml = std::size_t{1} << 30U;
    return limits;
}

/// Names the repairs of a lenient load (NodeSetSource::is_lenient).
enum class NodeSetRule : std::uint8_t {
    /// A reference to a node that is nowhere is left out.
    DanglingReference,
    /// An Object or Variable without a usable HasTypeDefinition becomes a BaseObjectType or
    /// BaseDataVariableType.
    TypeDefinition,
    /// A type without supertype is placed below the base type of its NodeClass, a DataType with
    /// fields below Structure or Enumeration.
    Supertype,
    /// A second type definition or supertype is left out.
    SecondType,
    /// A name without `<Alias>`, or one in a value, stands for the type of namespace 0 that has it.
    Alias,
    /// A RequiredModel is there in an older version.
    OlderModel,
    /// A DataType of a Variable that is nowhere becomes BaseDataType.
    DataType,
    /// A value that does not fit its Variable is converted, if that loses nothing.
    ValueConverted,
    /// A value that does not fit and cannot be converted, or that cannot be read, becomes null.
    ValueRemoved,
    /// ArrayDimensions that the value exceeds become 0, which allows any length (Part 3, 5.6.2).
    ArrayDimensions,
};
/// The number of rules.
inline constexpr std::size_t nodeset_rule_count = 10;

/// One change that a lenient load made.
struct NodeSetRepair {
    /// The rule that demanded it.
    NodeSetRule rule{};
    /// The place, and what was done there.
    Problem done;
};

/// `<RolePermission>` (Part 3, 8.55).
struct NodeSetPermission {
    NodeId role;
    std::uint32_t permissions{0};

    friend bool operator==(const NodeSetPermission&, const NodeSetPermission&) = default;
};

/// An XML attribute as in the file.
struct NodeSetAttribute {
    std::string name;
    std::string value;

    friend bool operator==(const NodeSetAttribute&, const NodeSetAttribute&) = default;
};

/// The extras of one node. Namespace indices are those of the server.
struct NodeSetNodeExtras {
    /// SymbolicName, ReleaseStatus and all others that are not attributes of the AddressSpace.
    std::vector<NodeSetAttribute> attributes;
    /// `<Category>`, `<Documentation>` and `<Extensions>`, as XML.
    std::string elements;
    NodeId method_declaration;
    /// Name and SymbolicName of a DataType's Definition, and the SymbolicNames of its fields.
    std::string definition_name;
    std::string definition_symbolic_name;
    std::vector<std::string> field_symbolic_names;

    friend bool operator==(const NodeSetNodeExtras&, const NodeSetNodeExtras&) = default;
};

/// A `<Model>` or `<RequiredModel>` (Part 6, F.5).
struct NodeSetModel {
    std::string uri;
    std::string version;
    std::string model_version;
    std::string publication_date;
    /// XmlSchemaUri, AccessRestrictions and attributes of later versions.
    std::vector<NodeSetAttribute> attributes;
    /// The AccessRestrictions in `attributes`, for the nodes that have none of their own.
    std::optional<std::uint16_t> access_restrictions;
    std::vector<NodeSetPermission> role_permissions;
    std::vector<NodeSetModel> required;
    /// The file that has it; not part of comparisons.
    std::uint32_t file{0};
    std::uint32_t line{0};

    friend bool operator==(const NodeSetModel& a, const NodeSetModel& b)
    {
        return a.uri == b.uri && a.version == b.version && a.model_version == b.model_version &&
               a.publication_date == b.publication_date && a.attributes == b.attributes &&
               a.role_permissions == b.role_permissions && a.required == b.required;
    }
};

/// The contents of NodeSet2 files that an AddressSpace does not keep (Part 6, Annex F): the loader
/// returns them and the writer writes them back.
struct NodeSetExtras {
    std::vector<NodeSetModel> models;
    /// Only nodes that have extras.
    std::unordered_map<NodeId, NodeSetNodeExtras> nodes;
    /// The content of `<Extensions>` of each file, as XML, by the URI of the file's first model.
    std::unordered_map<std::string, std::string> file_extensions;

    friend bool operator==(const NodeSetExtras&, const NodeSetExtras&) = default;
};

} // namespace busbar::model
