#include "emit.hpp"

#include <fstream>
#include <map>
#include <set>

#include <busbar/core/detail/basic_ids.hpp>
#include <model/nodeset/node_flags.hpp>

#include "names.hpp"

namespace busbar::generator {

namespace {

namespace basic_id = busbar::detail::basic_id;
using nodeset::Document;
using nodeset::Node;
using nodeset::NodeClass;

using Names = std::map<std::uint32_t, std::string>;

/// Gives nodes the names that the specifications' lists of NodeIds have: the BrowseNames on the
/// way from a type or a well-known object, joined with underscores.
class IdNames {
public:
    explicit IdNames(const Document& document) : document_{document}
    {
        for (const Node& node : document.nodes()) {
            for (const nodeset::Reference& reference : node.references) {
                if (reference.is_forward && is_part(reference.type)) {
                    parents_.emplace(reference.target, node.id);
                } else if (is_part(reference.type)) {
                    parents_.emplace(node.id, reference.target);
                }
            }
        }
    }

    [[nodiscard]] std::string name(const Node& node, unsigned depth = 0) const
    {
        constexpr unsigned most_levels = 32;
        const std::string own =
            type_name(node.symbolic_name.empty() ? node.browse_name : node.symbolic_name);
        const auto parent = parents_.find(node.id);
        const Node* const above = !node.parent.is_null()     ? document_.find(node.parent)
                                  : parent == parents_.end() ? nullptr
                                                             : document_.find(parent->second);
        if (above == nullptr || depth == most_levels || is_type(node) ||
            above->id.namespace_index() != node.id.namespace_index()) {
            return own;
        }
        return name(*above, depth + 1) + '_' + own;
    }

private:
    /// HasProperty, HasComponent, HasOrderedComponent.
    [[nodiscard]] static bool is_part(const NodeId& type)
    {
        return type.is(basic_id::HasProperty) || type.is(basic_id::HasComponent) ||
               type.is(basic_id::HasOrderedComponent);
    }

    const Document& document_;
    std::unordered_map<NodeId, NodeId> parents_;
};

/// Rows "Name,identifier,NodeClass".
Expected<Names, Failure> read_ids(const std::string& path)
{
    Names names;
    if (path.empty()) {
        return names;
    }
    std::ifstream file{path};
    if (!file) {
        return Unexpected{path + ": cannot be opened"};
    }
    std::string row;
    for (std::size_t line = 1; std::getline(file, row); ++line) {
        const std::size_t comma = row.find(',');
        char* end = nullptr;
        const unsigned long id =
            comma == std::string::npos ? 0 : std::strtoul(row.c_str() + comma + 1, &end, 10);
        if (end == nullptr || *end != ',' || id == 0 || id > UINT32_MAX) {
            return Unexpected{path + ":" + std::to_string(line) + ": found \"" + row +
                              "\", expected Name,identifier,NodeClass"};
        }
        names[static_cast<std::uint32_t>(id)] = type_name(row.substr(0, comma));
    }
    return names;
}

/// Adds the numeric nodes that the list does not have; every name is unique afterwards.
void add_names(const Schema& schema, const Document& document, Names& names)
{
    const IdNames maker{document};
    std::set<std::string> used;
    for (const auto& [id, name] : names) {
        used.insert(name);
    }
    for (const Node& node : document.nodes()) {
        if (!node.id.is_numeric() || node.id.namespace_index() != schema.namespace_index ||
            names.count(node.id.numeric()) != 0 || node.browse_name == "Default Binary") {
            continue;
        }
        std::string name = maker.name(node);
        if (!used.insert(name).second) {
            name += '_' + std::to_string(node.id.numeric());
            used.insert(name);
        }
        names.emplace(node.id.numeric(), std::move(name));
    }
}

std::string constant(const std::string& name, std::uint32_t id)
{
    return "inline constexpr std::uint32_t " + name + " = " + std::to_string(id) + ";\n";
}

} // namespace

Expected<std::string, Failure> emit_ids(const Schema& schema, const Document& document,
                                        const Options& options)
{
    auto names = read_ids(options.ids_file);
    if (!names) {
        return Unexpected{names.error()};
    }
    add_names(schema, document, *names);
    std::string text = preamble(schema) +
                       "#pragma once\n\n#include <cstdint>\n\n"
                       "/// Numeric NodeIds by the names of their nodes.\nnamespace " +
                       options.cpp_namespace + "::id {\n\n";
    for (const auto& [id, name] : *names) {
        text += constant(name, id);
    }
    text += "\n/// NodeIds of the binary encodings by their structures.\nnamespace encoding {\n\n";
    for (const Type& type : schema.types) {
        if (!type.encoding_id.is_null() && type.encoding_id.is_numeric()) {
            text += constant(type.name, type.encoding_id.numeric());
        }
    }
    return text + "\n} // namespace encoding\n\n} // namespace " + options.cpp_namespace + "::id\n";
}

} // namespace busbar::generator
