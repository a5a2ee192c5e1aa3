#include <busbar/model/relative_path.hpp>

#include <vector>

#include <busbar/types/ids.hpp>

#include "tables.hpp"

namespace busbar::model {

Result<RelativePath> parse_relative_path(std::string_view text, const SpaceReader& space)
{
    return parse_relative_path(text, [&](const QualifiedName& name) {
        const NodeIndex found = find_reference_type(space, name);
        return found == no_node ? NodeId{} : space.node_id(found);
    });
}

Result<std::string> to_text(const RelativePath& path, const SpaceReader& space)
{
    return to_text(path, [&](const NodeId& type) {
        const NodeIndex found = space.find(type);
        return found != no_node && space.node_class(found) == NodeClass::ReferenceType
                   ? space.browse_name(found)
                   : QualifiedName{};
    });
}

NodeIndex find_reference_type(const SpaceReader& space, const QualifiedName& name)
{
    std::vector<NodeIndex> types{space.find(id::References)};
    // A tree: each type has one supertype, so none appears twice.
    for (std::size_t i = 0; i < types.size() && types[i] != no_node; ++i) {
        if (space.browse_name(types[i]) == name) {
            return types[i];
        }
        ReferenceCursor cursor = space.references(types[i]);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, detail::id_has_subtype)) {
                types.push_back(reference->target);
            }
        }
    }
    return no_node;
}

} // namespace busbar::model
