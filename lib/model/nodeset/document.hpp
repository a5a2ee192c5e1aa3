#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/nodeset_types.hpp>

/// NodeSet2 files (Part 6, Annex F) as plain data. Used by the generator and by the model layer.
namespace busbar::nodeset {

/// The values of the NodeClass enumeration (Part 3, 8.29).
enum class NodeClass : std::uint8_t {
    Object = 1,
    Variable = 2,
    Method = 4,
    ObjectType = 8,
    VariableType = 16,
    ReferenceType = 32,
    DataType = 64,
    View = 128,
};

/// "Variable"; the view is of constant data.
[[nodiscard]] std::string_view name(NodeClass node_class);

struct Reference {
    NodeId type;
    NodeId target;
    bool is_forward{true};
    std::uint32_t line{0};
};

struct LocalizedText {
    std::string locale;
    std::string text;
};

/// A text of DisplayName, Description or InverseName after the first.
struct FurtherText {
    AttributeId attribute{AttributeId::DisplayName};
    LocalizedText text;
    std::uint32_t line{0};
};

/// One field of a DataType's Definition (Part 6, F.13). For an enumeration or an option set,
/// `value` is the number or the bit.
struct Field {
    std::string name;
    std::string symbolic_name;
    LocalizedText display_name;
    LocalizedText description;
    NodeId data_type{0, 24U};
    std::int32_t value_rank{-1};
    std::vector<std::uint32_t> array_dimensions;
    std::uint32_t max_string_length{0};
    std::int64_t value{-1};
    bool is_optional{false};
    bool allow_sub_types{false};
    std::uint32_t line{0};
};

/// The Definition of a DataType (Part 6, F.12).
struct Definition {
    std::string name;
    std::string symbolic_name;
    std::vector<Field> fields;
    bool is_union{false};
    bool is_option_set{false};
};

/// An XML element below <Value>: local name without prefix, text, children.
struct Element {
    std::string name;
    std::string text;
    std::vector<Element> children;
    std::uint32_t line{0};
    /// xsi:nil="true", or no child nodes at all.
    bool is_nil{false};
    /// xsi:nil="true".
    bool says_nil{false};
    /// For <XmlElement> and <Body>: the XML in it.
    std::string raw;

    /// Returns the first child with this local name, or null.
    [[nodiscard]] const Element* child(std::string_view local_name) const;
};

/// One node with the attributes of every NodeClass; those that do not apply have their defaults
/// (Part 6, F.4 to F.11). Every namespace index is one of Document::namespaces.
struct Node {
    NodeId id;
    NodeClass node_class{NodeClass::Object};
    std::uint16_t browse_namespace{0};
    std::string browse_name;
    std::string symbolic_name;
    /// Text is never empty: the BrowseName when the file gives none.
    LocalizedText display_name;
    LocalizedText description;
    LocalizedText inverse_name;
    /// The three texts above in further locales.
    std::vector<FurtherText> further_texts;
    std::vector<Reference> references;
    NodeId parent;
    /// Null if the node has none.
    std::unique_ptr<model::NodeSetNodeExtras> extras;

    // Variable and VariableType
    NodeId data_type{0, 24U};
    std::int32_t value_rank{-1};
    std::vector<std::uint32_t> array_dimensions;
    std::optional<Element> value;
    std::uint32_t access_level{1};
    double minimum_sampling_interval{0};
    bool historizing{false};

    // Types
    bool is_abstract{false};
    bool symmetric{false};
    std::optional<Definition> definition;

    // Object and View, Method
    std::uint8_t event_notifier{0};
    bool contains_no_loops{false};
    bool executable{true};

    // Every NodeClass
    std::uint32_t write_mask{0};
    std::optional<std::uint16_t> access_restrictions;
    /// Nothing if the node has none of its own; an empty list for HasNoPermissions (Part 6, F.3).
    std::optional<std::vector<model::NodeSetPermission>> role_permissions;

    /// The file that has it.
    std::uint32_t file{0};
    std::uint32_t line{0};
};

using Limits = model::NodeSetLimits;
using Model = model::NodeSetModel;

/// One file of a Document.
struct File {
    std::string name;
    /// The Document's index for each namespace index of the file.
    std::vector<std::uint16_t> namespaces{0};
    /// The content of the file's <Extensions>, as XML.
    std::string extensions;
    /// Its defects are repaired by rules (model::NodeSetRule).
    bool is_lenient{false};
};

/// Returns a Problem with a file, at a line of it unless that is 0, and with the node that the file
/// calls `node` unless that is empty: "tags.xml:17: ns=1;i=5: found NodeId ..., expected ...".
[[nodiscard]] Problem problem_at(const std::string& file, std::uint32_t line, std::string text,
                                 std::string_view node = {});

/// Any number of NodeSet2 files, with one table of namespaces. Thread-compatible.
class Document {
public:
    explicit Document(const Limits& limits = {}) : limits_{limits} {}
    /// Begins with these namespaces, of which the first is OPC UA's own.
    Document(const Limits& limits, std::vector<std::string> namespaces)
        : limits_{limits}, namespaces_{std::move(namespaces)}
    {
    }

    /// Adds the nodes of the file at `path`. If it returns problems, the document has what it
    /// understood and must not be used.
    [[nodiscard]] std::vector<Problem> load_file(const std::string& path, bool is_lenient = false);
    /// Loads a text in memory; `name` is used in messages.
    [[nodiscard]] std::vector<Problem> load_text(std::string_view text, const std::string& name,
                                                 bool is_lenient = false);
    /// Sets the types that names stand for in lenient files that lack an <Alias>.
    void set_published_names(std::unordered_map<std::string, NodeId> names)
    {
        published_names_ = std::move(names);
    }
    [[nodiscard]] const auto& published_names() const { return published_names_; }

    /// Index 0 is "http://opcfoundation.org/UA/"; others in the order in which files name them.
    [[nodiscard]] const std::vector<std::string>& namespaces() const { return namespaces_; }
    [[nodiscard]] std::optional<std::uint16_t> namespace_index(std::string_view uri) const;
    /// In the order of the files.
    [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
    [[nodiscard]] const std::vector<Model>& models() const { return models_; }
    [[nodiscard]] const std::vector<File>& files() const { return files_; }
    [[nodiscard]] const Node* find(const NodeId& id) const;
    [[nodiscard]] const Limits& limits() const { return limits_; }
    /// Returns a Problem with `node`, at a line of its file or, with 0, where it begins.
    [[nodiscard]] Problem problem(const Node& node, std::string text, std::uint32_t line = 0) const;
    [[nodiscard]] bool is_lenient(const Node& node) const { return files_[node.file].is_lenient; }

    /// Keeps at most Limits::max_errors repairs, and counts all.
    void add_repair(model::NodeSetRule rule, Problem done);
    [[nodiscard]] const std::vector<model::NodeSetRepair>& repairs() const { return repairs_; }
    [[nodiscard]] const auto& repair_counts() const { return repair_counts_; }

private:
    friend class FileReader;
    friend class Mender;

    Limits limits_;
    std::vector<std::string> namespaces_{"http://opcfoundation.org/UA/"};
    std::vector<Node> nodes_;
    std::vector<Model> models_;
    std::vector<File> files_;
    std::size_t kept_xml_{0};
    std::unordered_map<NodeId, std::size_t> by_id_;
    std::unordered_map<std::string, NodeId> published_names_;
    std::vector<model::NodeSetRepair> repairs_;
    std::array<std::size_t, model::nodeset_rule_count> repair_counts_{};
};

} // namespace busbar::nodeset
