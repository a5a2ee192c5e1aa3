#include "hierarchy.hpp"

#include <array>
#include <cstdlib>

namespace busbar::generator {

namespace {

using nodeset::has_subtype;

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

Hierarchy::Hierarchy(const nodeset::Document& document) : document_{document}, types_{document}
{
    for (const nodeset::Node& node : document.nodes()) {
        for (const nodeset::Reference& reference : node.references) {
            if (reference.type.is(has_subtype)) {
                const NodeId& source = reference.is_forward ? node.id : reference.target;
                supertypes_.emplace(reference.is_forward ? reference.target : node.id, source);
            }
        }
    }
}

const nodeset::Node* Hierarchy::supertype(const NodeId& id) const
{
    const auto found = supertypes_.find(id);
    return found == supertypes_.end() ? nullptr : document_.find(found->second);
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
