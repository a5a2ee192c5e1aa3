#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <model/nodeset/data_types.hpp>
#include <model/nodeset/document.hpp>

namespace busbar::generator {

namespace basic_id = busbar::detail::basic_id;

using nodeset::Kind;

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
    [[nodiscard]] Kind kind(const NodeId& id) const { return types_.kind(id); }
    [[nodiscard]] const nodeset::DataTypeTable& data_types() const { return types_; }
    /// The object named "Default Binary" that HasEncoding leads to; null if there is none.
    [[nodiscard]] NodeId binary_encoding(const NodeId& data_type) const
    {
        return types_.binary_encoding(data_type);
    }
    /// An unsigned number whose bits have names (Part 3, 8.40).
    [[nodiscard]] bool is_number_option_set(const nodeset::Node& node) const;
    /// The abstract structure OptionSet of Part 5, 12.2.21.
    [[nodiscard]] bool is_option_set_base(const NodeId& id) const
    {
        return id.is(basic_id::OptionSet);
    }
    /// Structure and Union themselves, which stand for any subtype.
    [[nodiscard]] bool is_open_structure(const NodeId& id) const
    {
        return nodeset::DataTypeTable::is_open_structure(id);
    }
    /// Names and values of an enumeration or option set: those of its Definition.
    [[nodiscard]] std::vector<nodeset::Field> enumeration_fields(const nodeset::Node& node) const;

private:
    const nodeset::Document& document_;
    nodeset::DataTypeTable types_;
    std::unordered_map<NodeId, NodeId> supertypes_;
};

} // namespace busbar::generator
