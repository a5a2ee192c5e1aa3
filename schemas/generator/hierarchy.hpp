#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <model/nodeset/document.hpp>

namespace busbar::generator {

/// What a DataType is on the wire: a built-in type by its id, or one of the kinds behind them.
enum class Kind : std::uint8_t {
    Unknown = 0,
    // 1 to 25: BuiltInType
    Structure = 22,
    Variant = 24,
    Enumeration = 29,
    OptionSetStructure = 100,
    Union = 101,
};

struct BuiltInName {
    const char* cpp;
    std::size_t min_wire_size;
    /// Declared in namespace busbar.
    bool is_busbar;
};

[[nodiscard]] const BuiltInName& built_in(Kind kind);
/// The bits of "std::uint16_t".
[[nodiscard]] std::int64_t built_in_bits(const std::string& underlying);

/// The DataTypes' supertypes and encodings, with references of both directions.
class Hierarchy {
public:
    explicit Hierarchy(const nodeset::Document& document);

    [[nodiscard]] const nodeset::Node* supertype(const NodeId& id) const;
    /// Resolved along HasSubtype (Part 6, 5.1.2).
    [[nodiscard]] Kind kind(const NodeId& id) const;
    /// The object named "Default Binary" that HasEncoding leads to; null if there is none.
    [[nodiscard]] NodeId binary_encoding(const NodeId& data_type) const;
    /// An unsigned number whose bits have names (Part 3, 8.40).
    [[nodiscard]] bool is_number_option_set(const nodeset::Node& node) const;
    /// The abstract structure OptionSet of Part 5, 12.2.21.
    [[nodiscard]] bool is_option_set_base(const NodeId& id) const { return id.is(12755); }
    /// Structure and Union themselves, which stand for any subtype.
    [[nodiscard]] bool is_open_structure(const NodeId& id) const
    {
        return id.is(22) || id.is(12756) || is_option_set_base(id);
    }
    /// Names and values of an enumeration or option set: those of its Definition.
    [[nodiscard]] std::vector<nodeset::Field> enumeration_fields(const nodeset::Node& node) const;

private:
    const nodeset::Document& document_;
    std::unordered_map<NodeId, NodeId> supertype_;
    std::unordered_map<NodeId, NodeId> encoding_;
};

} // namespace busbar::generator
