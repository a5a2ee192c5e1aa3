#include <busbar/core/detail/guarded.hpp>
#include <busbar/model/address_space.hpp>

#include "core/utf8.hpp"
#include "tables.hpp"
#include "translations.hpp"

namespace busbar::model {

using detail::IndexTable;
using detail::NodeRecord;
using detail::Tables;

namespace {

/// The longest String or Opaque identifier in bytes (Part 3, 8.2.4).
constexpr std::size_t max_identifier_size = 4096;

bool is_valid_id(const SpaceReader& space, const NodeId& id)
{
    if (id.namespace_index() >= space.namespace_count()) {
        return false;
    }
    if (id.id_type() == IdType::String) {
        return !id.string().empty() && id.string().size() <= max_identifier_size &&
               busbar::detail::is_valid_text(id.string().view());
    }
    return id.id_type() != IdType::Opaque ||
           (!id.opaque().empty() && id.opaque().size() <= max_identifier_size);
}

/// Returns the default ReferenceType from the parent.
std::uint32_t default_reference(const SpaceReader& space, NodeIndex parent, NodeClass node_class)
{
    if (detail::is_type(node_class)) {
        return detail::id_has_subtype;
    }
    const bool is_folder =
        space.node_class(parent) == NodeClass::View ||
        space.is_subtype_of(space.type_definition(parent), detail::id_folder_type);
    return is_folder ? detail::id_organizes : detail::id_has_component;
}

StatusCode check_reference(const SpaceReader& space, const NewNode& node, NodeIndex reference,
                           NodeClass node_class)
{
    if (reference == no_node || space.node_class(reference) != NodeClass::ReferenceType ||
        space.is_abstract(reference)) {
        return status::Bad_ReferenceTypeIdInvalid;
    }
    if (reference == space.find(detail::id_has_encoding) && node_class == NodeClass::Object &&
        space.node_class(node.parent) == NodeClass::DataType) {
        return status::Good; // an encoding cannot be below anything else (Part 3, 5.8.4)
    }
    if (!space.is_subtype_of(reference, detail::id_hierarchical_references)) {
        return status::Bad_ReferenceNotAllowed;
    }
    // HasSubtype leads from a type to a type of the same NodeClass, and every type has one above
    // (Part 3, 7.10).
    const bool is_subtype = space.is_subtype_of(reference, detail::id_has_subtype);
    const bool is_allowed = is_subtype == detail::is_type(node_class) &&
                            (!is_subtype || space.node_class(node.parent) == node_class);
    return is_allowed ? status::Good : status::Bad_ReferenceNotAllowed;
}

StatusCode check_names(const SpaceReader& space, const Tables& tables, const NewNode& node,
                       NodeIndex reference)
{
    if (!node.id.is_null()) {
        if (!is_valid_id(space, node.id)) {
            return status::Bad_NodeIdInvalid;
        }
        if (tables.find(node.id) != no_node) {
            return status::Bad_NodeIdExists;
        }
    }
    const QualifiedName& name = node.browse_name;
    if (name.name.empty() || name.name.size() > busbar::detail::max_browse_name ||
        name.namespace_index >= space.namespace_count() ||
        !busbar::detail::is_valid_text(name.name.view())) {
        return status::Bad_BrowseNameInvalid;
    }
    if (!detail::is_valid_text(node.display_name) || !detail::is_valid_text(node.description)) {
        return status::Bad_EncodingError;
    }
    bool is_taken = tables.find_child(node.parent, name, [&](NodeIndex child) {
        return tables.links(child).parent_reference == reference;
    }) != no_node;
    if (!is_taken && tables.is_constant(node.parent)) {
        static_cast<void>(space.for_each_child(node.parent, reference, false, name, [&](NodeIndex) {
            is_taken = true;
            return false;
        }));
    }
    return is_taken ? status::Bad_BrowseNameDuplicated : status::Good;
}

} // namespace

/// Checks the common attributes of a new node of any NodeClass and creates it.
Result<NodeIndex> AddressSpace::create(const NewNode& node, NodeClass node_class)
{
    Tables& tables = *tables_;
    if (!exists(node.parent)) {
        return fail(status::Bad_ParentNodeIdInvalid);
    }
    const NodeIndex reference = node.reference_type.is_null()
                                    ? find(default_reference(*this, node.parent, node_class))
                                    : find(node.reference_type);
    if (const auto bad = check_reference(*this, node, reference, node_class); !bad.is_good()) {
        return fail(bad);
    }
    if (const auto bad = check_names(*this, tables, node, reference); !bad.is_good()) {
        return fail(bad);
    }
    if (tables.record_count + std::size_t{1} >= IndexTable::max_records) {
        return fail(status::Bad_OutOfMemory);
    }
    const NodeIndex created = node.id.is_null()
                                  ? tables.create(tables.free_id(node.browse_name.namespace_index),
                                                  node.browse_name, node_class)
                                  : tables.create(node.id, node.browse_name, node_class);
    busbar::detail::Undo undo{[&] {
        tables.unlink(created);
        tables.destroy(created);
    }};
    tables.link(node.parent, reference, created);
    NodeRecord& record = tables.record(created);
    if (!node.display_name.text.is_null()) {
        record.make_extra().display_name = node.display_name;
    }
    if (!node.description.text.is_null()) {
        record.make_extra().description = node.description;
    }
    if (detail::is_type(node_class)) {
        tables.place_type(created, node.parent);
    }
    undo.keep();
    return created;
}

} // namespace busbar::model
