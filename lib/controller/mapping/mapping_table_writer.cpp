#include <algorithm>
#include <utility>
#include <vector>

#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/model_set.hpp>
#include <busbar/controller/node_roles.hpp>
#include <busbar/model/relative_path.hpp>
#include <busbar/types/ids.hpp>

#include "table_fields.hpp"

namespace busbar::controller {

namespace {

using model::NodeIndex;

/// Returns whether the node, which must be one of a model, has RolePermissions of its own.
bool has_roles(const model::SpaceReader& space, NodeIndex node)
{
    const model::NodeAccess* const access = space.node_access(node);
    return access != nullptr && !access->role_permissions.is_null() &&
           space.node_id(node).namespace_index() != 0;
}

class TableWriter {
public:
    explicit TableWriter(const model::SpaceReader& space, bool has_types = false)
        : space_{space}, has_types_{has_types}
    {
        for (const std::string_view column : detail::table_columns) {
            text_ += text_.empty() ? "" : ",";
            text_ += column;
        }
        text_ += has_types_ ? ",Type\r\n" : "\r\n";
    }

    void write(NodeIndex node, const DataMapping& mapping)
    {
        begin(node);
        write_part(mapping.value, {});
        if (!mapping.quality.empty()) {
            write_line({.label = mapping.quality}, std::string{detail::quality_part});
        }
        write_scaling(mapping);
    }
    void write(NodeIndex node, const MethodMapping& mapping)
    {
        begin(node);
        if (!mapping.handle.empty()) {
            write_line({.label = mapping.handle}, std::string{detail::handle_part});
        }
        if (!mapping.done.empty()) {
            write_line({.label = mapping.done}, std::string{detail::done_part});
        }
        write_arguments(mapping.arguments, detail::input_part);
        write_arguments(mapping.outputs, detail::output_part);
    }
    /// Writes a line for each part that can be mapped, and for the quality and scaling in `mapped`,
    /// which may be null.
    void write(NodeIndex node, const std::vector<MappablePart>& parts, const DataMapping* mapped)
    {
        begin(node);
        if (mapped != nullptr) {
            write_specifications(mapped->value, {});
        }
        for (const MappablePart& part : parts) {
            write_line({.label = part.label}, part.path, part.type);
        }
        if (mapped != nullptr) {
            write_scaling(*mapped);
        }
    }
    /// Writes the node's own RolePermissions, if it has any.
    void write_roles(NodeIndex node)
    {
        if (has_roles(space_, node)) {
            begin(node);
            write_line({.label = roles_text(space_.node_access(node)->role_permissions.span())},
                       std::string{detail::roles_part});
        }
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

private:
    void begin(NodeIndex node)
    {
        const NodeId id = space_.node_id(node);
        const std::string uri{space_.namespace_uri(id.namespace_index())};
        NodeId plain = id;
        plain.set_namespace_index(0);
        // A semicolon would end the URI.
        const bool has_uri = id.namespace_index() != 0 && uri.find(';') == std::string::npos;
        node_.clear();
        detail::add_field(node_,
                          has_uri ? to_string(ExpandedNodeId{plain, String{uri}}) : to_string(id));
        node_ += ',';
        detail::add_field(node_, path_of(node));
        node_ += ',';
    }

    /// Returns the path from the Root, along the first parents that hierarchical references name.
    [[nodiscard]] std::string path_of(NodeIndex node) const
    {
        constexpr std::size_t max_levels = 100;
        std::vector<RelativePathElement> elements;
        const NodeIndex root = space_.find(id::RootFolder);
        for (NodeIndex at = node; at != root; at = parent_of(at)) {
            if (at == model::no_node || elements.size() == max_levels) {
                return {};
            }
            elements.push_back(
                {NodeId{0, id::HierarchicalReferences}, false, true, space_.browse_name(at)});
        }
        std::reverse(elements.begin(), elements.end());
        const auto text =
            model::to_text(RelativePath{Array<RelativePathElement>{elements}}, space_);
        return text ? *text : std::string{};
    }
    [[nodiscard]] NodeIndex parent_of(NodeIndex node) const
    {
        model::ReferenceCursor cursor = space_.references(node);
        while (const auto reference = cursor.next()) {
            if (!reference->is_forward &&
                space_.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                !space_.is_subtype_of(reference->type, id::HasEventSource)) {
                return reference->target;
            }
        }
        return model::no_node;
    }

    void write_scaling(const DataMapping& mapping)
    {
        if (mapping.scaling.is_set()) {
            write_line({.label = to_text(mapping.scaling)}, std::string{detail::scaling_part});
        }
    }
    void write_arguments(const std::vector<MappedPart>& arguments, std::string_view place)
    {
        for (const MappedPart& argument : arguments) {
            write_part(argument, std::string{place} + '[' + std::to_string(argument.number) + ']');
        }
    }
    void write_part(const MappedPart& part, const std::string& path)
    {
        if (!part.label.empty() || part.specification.rank != ArraySpecification::none) {
            write_line(part, path);
        }
        for (const MappedPart& inner : part.parts) {
            write_part(inner, part_path(path, inner));
        }
    }
    void write_specifications(const MappedPart& part, const std::string& path)
    {
        if (part.specification.rank != ArraySpecification::none) {
            write_line({.specification = part.specification}, path);
        }
        for (const MappedPart& inner : part.parts) {
            write_specifications(inner, part_path(path, inner));
        }
    }
    void write_line(const MappedPart& part, const std::string& path, const std::string& type = {})
    {
        text_ += node_;
        detail::add_field(text_, path);
        text_ += ',';
        detail::add_field(text_, part.label);
        text_ += ',';
        const ArraySpecification& specification = part.specification;
        const bool is_specified = specification.rank != ArraySpecification::none;
        text_ += is_specified ? std::to_string(specification.rank) : std::string{};
        for (const std::uint32_t dimension : specification.dimensions) {
            text_ += ',';
            text_ += is_specified && dimension != 0 ? std::to_string(dimension) : std::string{};
        }
        text_ += has_types_ ? "," + type + "\r\n" : "\r\n";
    }

    const model::SpaceReader& space_;
    bool has_types_;
    std::string text_;
    /// The fields of the current node, which each of its lines begins with.
    std::string node_;
};

} // namespace

std::string write_mapping_table(const model::SpaceReader& space, const Mapping& mapping)
{
    TableWriter writer{space};
    std::vector<NodeId> nodes = mapped_nodes(mapping);
    space.for_each([&](NodeIndex node) {
        if (has_roles(space, node)) {
            nodes.push_back(space.node_id(node));
        }
    });
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const NodeId& id : nodes) {
        const NodeIndex node = space.find(id);
        if (node == model::no_node) {
            continue;
        }
        const auto variable = mapping.variables.find(id);
        const auto method = mapping.methods.find(id);
        if (variable != mapping.variables.end()) {
            writer.write(node, variable->second);
        } else if (method != mapping.methods.end()) {
            writer.write(node, method->second);
        }
        writer.write_roles(node);
    }
    return writer.take();
}

std::string write_mappable_table(const ModelSet& models, PartsWritten written)
{
    const model::SpaceReader& space = models.space();
    std::vector<std::pair<NodeId, NodeIndex>> nodes;
    space.for_each([&](NodeIndex node) { nodes.emplace_back(space.node_id(node), node); });
    std::sort(nodes.begin(), nodes.end());
    TableWriter writer{space, true};
    MappableParts parts{models};
    const auto& variables = models.mapping().variables;
    for (const auto& [id, node] : nodes) {
        std::vector<MappablePart> found = parts.of(node);
        if (written == PartsWritten::Unmapped) {
            std::erase_if(found, [](const MappablePart& part) { return !part.label.empty(); });
        }
        const auto mapped = variables.find(id);
        const bool has_more = written == PartsWritten::All && mapped != variables.end();
        if (!found.empty()) {
            writer.write(node, found, has_more ? &mapped->second : nullptr);
        }
        if (written == PartsWritten::All) {
            writer.write_roles(node);
        }
    }
    return writer.take();
}

} // namespace busbar::controller
