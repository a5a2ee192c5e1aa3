#include "hierarchy.hpp"

#include <array>
#include <cstdlib>

namespace busbar::generator {

namespace {

constexpr std::uint32_t has_encoding = 38;
constexpr std::uint32_t has_subtype = 45;

// In the order of the built-in type ids, from Boolean on.
constexpr std::array<BuiltInName, 25> names = {{
    {"bool", 1, false},           {"std::int8_t", 1, false},   {"std::uint8_t", 1, false},
    {"std::int16_t", 2, false},   {"std::uint16_t", 2, false}, {"std::int32_t", 4, false},
    {"std::uint32_t", 4, false},  {"std::int64_t", 8, false},  {"std::uint64_t", 8, false},
    {"float", 4, false},          {"double", 8, false},        {"String", 4, true},
    {"DateTime", 8, true},        {"Guid", 16, true},          {"ByteString", 4, true},
    {"XmlElement", 4, true},      {"NodeId", 2, true},         {"ExpandedNodeId", 2, true},
    {"StatusCode", 4, true},      {"QualifiedName", 6, true},  {"LocalizedText", 1, true},
    {"ExtensionObject", 3, true}, {"DataValue", 1, true},      {"Variant", 1, true},
    {"DiagnosticInfo", 1, true},
}};

/// The kinds at which the way up the hierarchy ends.
Kind final_kind(const NodeId& id)
{
    if (!id.is_numeric() || id.namespace_index() != 0) {
        return Kind::Unknown;
    }
    switch (id.numeric()) {
    case 26: // Number
    case 27: // Integer
    case 28: // UInteger
    case 50: // Decimal
        return Kind::Variant;
    case 29:
        return Kind::Enumeration;
    case 12755:
        return Kind::OptionSetStructure;
    case 12756:
        return Kind::Union;
    default:
        return id.numeric() >= 1 && id.numeric() <= names.size() ? static_cast<Kind>(id.numeric())
                                                                 : Kind::Unknown;
    }
}

} // namespace

const BuiltInName& built_in(Kind kind)
{
    return names[static_cast<std::size_t>(kind) - 1];
}

std::int64_t built_in_bits(const std::string& underlying)
{
    constexpr std::size_t prefix = std::string_view{"std::uint"}.size();
    return std::strtol(underlying.c_str() + prefix, nullptr, 10);
}

Hierarchy::Hierarchy(const nodeset::Document& document) : document_{document}
{
    for (const nodeset::Node& node : document.nodes()) {
        for (const nodeset::Reference& reference : node.references) {
            const NodeId& source = reference.is_forward ? node.id : reference.target;
            const NodeId& target = reference.is_forward ? reference.target : node.id;
            if (reference.type.is(has_subtype)) {
                supertype_.emplace(target, source);
            } else if (reference.type.is(has_encoding)) {
                const nodeset::Node* const encoding = document.find(target);
                if (encoding != nullptr && encoding->browse_name == "Default Binary") {
                    encoding_.emplace(source, target);
                }
            }
        }
    }
}

const nodeset::Node* Hierarchy::supertype(const NodeId& id) const
{
    const auto found = supertype_.find(id);
    return found == supertype_.end() ? nullptr : document_.find(found->second);
}

Kind Hierarchy::kind(const NodeId& id) const
{
    constexpr unsigned most_levels = 100;
    NodeId at = id;
    for (unsigned level = 0; level < most_levels; ++level) {
        if (const Kind kind = final_kind(at); kind != Kind::Unknown) {
            return kind;
        }
        const auto above = supertype_.find(at);
        if (above == supertype_.end()) {
            break;
        }
        at = above->second;
    }
    return Kind::Unknown;
}

NodeId Hierarchy::binary_encoding(const NodeId& data_type) const
{
    const auto found = encoding_.find(data_type);
    return found == encoding_.end() ? NodeId{} : found->second;
}

bool Hierarchy::is_number_option_set(const nodeset::Node& node) const
{
    constexpr std::array unsigned_kinds = {3U, 5U, 7U, 9U};
    const auto kind_of_node = static_cast<unsigned>(kind(node.id));
    for (const unsigned kind : unsigned_kinds) {
        if (kind == kind_of_node) {
            return node.definition && !node.definition->fields.empty();
        }
    }
    return false;
}

std::vector<nodeset::Field> Hierarchy::enumeration_fields(const nodeset::Node& node) const
{
    return node.definition ? node.definition->fields : std::vector<nodeset::Field>{};
}

} // namespace busbar::generator
