#include "load_plan.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "data_types.hpp"
#include "node_flags.hpp"

namespace busbar::nodeset {

namespace {

/// The longest name of a node in characters (Part 3, 8.3), and identifier in bytes (Part 3, 8.2.4).
constexpr std::size_t max_name_size = 512;
constexpr std::size_t max_identifier_size = 4096;

std::size_t identifier_size(const NodeId& id)
{
    switch (id.id_type()) {
    case IdType::String:
        return id.string().size();
    case IdType::Opaque:
        return id.opaque().size();
    default:
        return 1;
    }
}

std::string a(NodeClass node_class)
{
    const std::string_view text = name(node_class);
    return (text.front() == 'O' ? "an " : "a ") + std::string{text};
}

/// Describes a missing node; a server may be built without parts of namespace 0.
std::string nowhere(const NodeId& id)
{
    std::string text = "in no file and not in the address space";
    if (id.namespace_index() == 0) {
        text += ", whose namespace 0 may have been built without it";
    }
    return text;
}

} // namespace

LoadPlan::LoadPlan(const Document& document, const model::SpaceReader& space)
    : document_{document}, space_{space}, supertypes_(document.nodes().size()),
      type_definitions_(document.nodes().size())
{
}

void LoadPlan::add_error(Problem error)
{
    if (errors_.size() < std::max<std::size_t>(document_.limits().max_errors, 1)) {
        errors_.push_back(std::move(error));
    }
}

void LoadPlan::fail(const Node& node, std::string message, std::uint32_t line)
{
    add_error(document_.problem(node, std::move(message), line));
}

void LoadPlan::add_note(Problem note)
{
    if (notes_.size() < document_.limits().max_errors) {
        notes_.push_back(std::move(note));
    }
}

std::string LoadPlan::text(const NodeId& id) const
{
    const auto& namespaces = document_.namespaces();
    if (id.namespace_index() == 0 || id.namespace_index() >= namespaces.size()) {
        return to_string(id);
    }
    NodeId bare = id;
    bare.set_namespace_index(0);
    return to_string(ExpandedNodeId{bare, String{namespaces[id.namespace_index()]}});
}

bool LoadPlan::is_skipped(const Node& node) const
{
    return node.id.namespace_index() == 0 && space_.find(node.id) != model::no_node;
}

Target LoadPlan::find(const NodeId& id) const
{
    const Node* const node = document_.find(id);
    if (node != nullptr && !is_skipped(*node)) {
        return {node, model::no_node};
    }
    return {nullptr, space_.find(id)};
}

NodeClass LoadPlan::class_of(const Target& target) const
{
    return target.node != nullptr ? target.node->node_class
                                  : static_cast<NodeClass>(space_.node_class(target.index));
}

bool LoadPlan::is_abstract(const Target& target) const
{
    return target.node != nullptr ? target.node->is_abstract : space_.is_abstract(target.index);
}

void LoadPlan::check()
{
    for (const Node& node : document_.nodes()) {
        const bool is_old = is_skipped(node);
        if (!is_old) {
            check_names(node);
        }
        for (const Reference& reference : node.references) {
            // An old type of namespace 0 may name a new one, which need not name it.
            const bool is_new = !is_old || find(reference.target).node != nullptr;
            if (is_new && reference.type.is(has_subtype)) {
                check_supertype(node, reference);
            } else if (!is_old && reference.type.is(has_type_definition)) {
                check_type_definition(node, reference);
            }
        }
    }
    check_definitions();
    if (!errors_.empty()) {
        return;
    }
    check_type_levels();
    if (!errors_.empty()) {
        return;
    }
    for (const Node& node : document_.nodes()) {
        if (!is_skipped(node)) {
            for (const Reference& reference : node.references) {
                check_reference(node, reference);
            }
        }
    }
    if (errors_.empty()) {
        check_circles();
    }
}

void LoadPlan::check_names(const Node& node)
{
    const std::size_t size = identifier_size(node.id);
    if (size == 0 || size > max_identifier_size) {
        fail(node, "found an identifier of " + std::to_string(size) + " bytes, expected 1 to " +
                       std::to_string(max_identifier_size));
    }
    if (node.browse_name.empty() || node.browse_name.size() > max_name_size) {
        fail(node, "found a BrowseName of " + std::to_string(node.browse_name.size()) +
                       " bytes, expected 1 to " + std::to_string(max_name_size));
    }
    if (space_.find(node.id) != model::no_node) {
        fail(node, "the address space has a node of this NodeId");
    }
    if (node.node_class == NodeClass::Variable || node.node_class == NodeClass::VariableType) {
        check_data_type(node);
    }
}

void LoadPlan::check_data_type(const Node& node)
{
    const Target type = find(node.data_type);
    if (!type.exists() || class_of(type) != NodeClass::DataType) {
        fail(node, "found the DataType " + text(node.data_type) + ", which is " +
                       (type.exists() ? a(class_of(type)) : nowhere(node.data_type)));
    }
    if (node.value_rank < -3) {
        fail(node, "found ValueRank=" + std::to_string(node.value_rank) + ", expected -3 or more");
    }
}

/// Each type has one supertype of its own NodeClass (Part 3, 7.10).
void LoadPlan::check_supertype(const Node& node, const Reference& reference)
{
    const NodeId& subtype_id = reference.is_forward ? reference.target : node.id;
    const NodeId& supertype_id = reference.is_forward ? node.id : reference.target;
    const Target subtype = find(subtype_id);
    const Target supertype = find(supertype_id);
    if (!subtype.exists() || !supertype.exists()) {
        fail(node,
             "found a HasSubtype reference to " + text(reference.target) + ", which is " +
                 nowhere(reference.target),
             reference.line);
        return;
    }
    if (class_of(subtype) != class_of(supertype)) {
        fail(node,
             "found a HasSubtype reference from " + a(class_of(supertype)) + " to " +
                 a(class_of(subtype)) + ", expected types of one NodeClass",
             reference.line);
        return;
    }
    if (subtype.node == nullptr) {
        if (space_.supertype(subtype.index) != supertype.index || supertype.node != nullptr) {
            fail(node,
                 "found a second supertype of " + text(subtype_id) +
                     ", which is in the address space",
                 reference.line);
        }
        return;
    }
    NodeId& known = supertypes_[position(*subtype.node)];
    if (!known.is_null() && known != supertype_id) {
        fail(node, "found the supertype " + text(supertype_id) + ", expected only " + text(known),
             reference.line);
    }
    known = supertype_id;
}

/// Each Object and Variable has one type definition (Part 3, 7.13).
void LoadPlan::check_type_definition(const Node& node, const Reference& reference)
{
    const NodeId& type_id = reference.is_forward ? reference.target : node.id;
    const Target instance =
        reference.is_forward ? Target{&node, model::no_node} : find(reference.target);
    const Target type = find(type_id);
    if (instance.node == nullptr) {
        return;
    }
    if (!is_instance(instance.node->node_class)) {
        fail(node, "found a HasTypeDefinition reference from " + a(instance.node->node_class),
             reference.line);
        return;
    }
    const NodeClass expected = instance.node->node_class == NodeClass::Object
                                   ? NodeClass::ObjectType
                                   : NodeClass::VariableType;
    if (!type.exists() || class_of(type) != expected) {
        fail(node,
             "found the type definition " + text(type_id) + ", which is " +
                 (type.exists() ? a(class_of(type)) + ", expected " + a(expected)
                                : nowhere(type_id)),
             reference.line);
        return;
    }
    NodeId& known = type_definitions_[position(*instance.node)];
    if (!known.is_null() && known != type_id) {
        fail(node, "found the type definition " + text(type_id) + ", expected only " + text(known),
             reference.line);
    }
    known = type_id;
}

void LoadPlan::check_definitions()
{
    for (const Node& node : document_.nodes()) {
        if (is_skipped(node)) {
            continue;
        }
        if (is_type(node) && supertypes_[position(node)].is_null()) {
            fail(node, "found " + a(node.node_class) + " without supertype");
        }
        if (is_instance(node.node_class) && type_definitions_[position(node)].is_null()) {
            fail(node, "found " + a(node.node_class) + " without HasTypeDefinition");
        }
        note_field_types(node);
    }
}

void LoadPlan::note_field_types(const Node& node)
{
    for (const Field& field : node.definition ? node.definition->fields : std::vector<Field>{}) {
        const Target type = find(field.data_type);
        if (!type.exists() || class_of(type) != NodeClass::DataType) {
            add_note(document_.problem(
                node,
                "found the field \"" + printable(field.name, 80) + "\" of the DataType " +
                    text(field.data_type) + ", which is " +
                    (type.exists() ? a(class_of(type)) : nowhere(field.data_type)) +
                    "; clients cannot read values with it",
                field.line));
        }
    }
}

void LoadPlan::check_reference(const Node& node, const Reference& reference)
{
    const Target type = find(reference.type);
    if (!type.exists() || class_of(type) != NodeClass::ReferenceType) {
        fail(node,
             "found the ReferenceType " + text(reference.type) + ", which is " +
                 (type.exists() ? a(class_of(type)) : nowhere(reference.type)),
             reference.line);
        return;
    }
    if (is_abstract(type)) {
        fail(node, "found a reference of the abstract ReferenceType " + text(reference.type),
             reference.line);
        return;
    }
    const bool is_hierarchical = is_below(reference.type, 33);
    if (!find(reference.target).exists()) {
        const std::string message = "found a reference to " + text(reference.target) +
                                    ", which is " + nowhere(reference.target);
        if (is_hierarchical) {
            fail(node, message, reference.line);
        } else {
            add_note(document_.problem(node, message, reference.line));
        }
    } else if (is_hierarchical && reference.target == node.id) {
        // Part 3, 7.3
        fail(node, "found a hierarchical reference from the node to itself", reference.line);
    }
}

} // namespace busbar::nodeset
