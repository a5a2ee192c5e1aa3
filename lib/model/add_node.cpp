#include <busbar/core/detail/guarded.hpp>
#include <busbar/model/address_space.hpp>

#include "tables.hpp"

namespace busbar::model {

using detail::NodeRecord;

namespace {

/// Finds the concrete type of a new Object or Variable.
Result<NodeIndex> definition_of(const SpaceReader& space, const NodeId& type, NodeClass type_class)
{
    const NodeIndex found = space.find(type);
    if (found == no_node || space.node_class(found) != type_class || space.is_abstract(found)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return found;
}

/// Returns the DataType of a new Variable or VariableType, if its other attributes are valid.
Result<NodeIndex> data_type_of(const SpaceReader& space, const NodeId& id, std::int32_t rank,
                               const Array<std::uint32_t>& dimensions, const Variant& value)
{
    const NodeIndex found = space.find(id);
    const bool is_sound =
        found != no_node && space.node_class(found) == NodeClass::DataType && rank >= -3 &&
        (dimensions.empty() || rank > 0) &&
        (dimensions.empty() || dimensions.size() == static_cast<std::size_t>(rank));
    if (!is_sound) {
        return fail(status::Bad_NodeAttributesInvalid);
    }
    if (!value.is_null()) {
        const StatusCode fits = space.check_value(value, found, rank, dimensions.span());
        if (!fits.is_good()) {
            return fail(fits);
        }
    }
    return found;
}

/// Returns the NodeId of a Variable that is named after its place.
NodeId path_id(const NodeId& parent, const QualifiedName& name)
{
    const bool continues =
        parent.id_type() == IdType::String && parent.namespace_index() == name.namespace_index;
    return continues ? NodeId{name.namespace_index, parent.string().str() + '/' + name.name.str()}
                     : NodeId{name.namespace_index, name.name};
}

void set_shape(NewVariable& variable, const Variant& like)
{
    if (like.is_matrix()) {
        variable.array_dimensions = Array<std::uint32_t>{like.dimensions()};
    } else if (like.is_array()) {
        variable.array_dimensions = {static_cast<std::uint32_t>(like.array_size())};
    }
    if (like.is_array()) {
        variable.value_rank = static_cast<std::int32_t>(variable.array_dimensions.size());
    }
}

StatusCode check_arguments(const SpaceReader& space, const Array<Argument>& arguments)
{
    for (const Argument& argument : arguments) {
        const auto data_type = data_type_of(space, argument.data_type, argument.value_rank,
                                            argument.array_dimensions, Variant{});
        if (!data_type) {
            return data_type.error();
        }
    }
    return status::Good;
}

/// Returns the property of a Method that describes `arguments`, of which there is at least one.
NewVariable argument_property(const Array<Argument>& arguments)
{
    Array<ExtensionObject> descriptions;
    descriptions.reserve(arguments.size());
    for (const Argument& argument : arguments) {
        descriptions.push_back(ExtensionObject::from(argument));
    }
    NewVariable property;
    property.data_type = NodeId{0, detail::id_argument};
    property.value_rank = 1;
    property.value = std::move(descriptions);
    return property;
}

/// Returns an unused NodeId for a Property of a Method. It is in the Method's namespace, and for a
/// Method of the specification the next number, as there (Part 6, Annex A).
NodeId argument_id(detail::Tables& tables, const NodeId& method)
{
    if (method.namespace_index() == 0 && method.is_numeric()) {
        for (const std::uint32_t distance : {1U, 2U}) {
            const NodeId next{0, method.numeric() + distance};
            if (tables.find(next) == no_node) {
                return next;
            }
        }
    }
    return tables.free_id(method.namespace_index());
}

std::uint8_t flag(bool is_set, std::uint8_t bit)
{
    return is_set ? bit : std::uint8_t{0};
}

} // namespace

Result<NodeIndex> AddressSpace::add_object(const NewNode& node, const NewObject& object)
{
    const auto type = definition_of(*this, object.type_definition, NodeClass::ObjectType);
    if (!type) {
        return type;
    }
    const auto created = create(node, NodeClass::Object);
    if (created) {
        NodeRecord& record = tables_->record(*created);
        tables_->links(*created).type_definition = *type;
        record.event_notifier = object.event_notifier;
    }
    return created;
}

Result<NodeIndex> AddressSpace::add_folder(const NewNode& node)
{
    return add_object(node, NewObject{NodeId{0, detail::id_folder_type}, 0});
}

Result<NodeIndex> AddressSpace::add_variable(const NewNode& node, const NewVariable& variable)
{
    const auto type = definition_of(*this, variable.type_definition, NodeClass::VariableType);
    if (!type) {
        return type;
    }
    const auto data_type = data_type_of(*this, variable.data_type, variable.value_rank,
                                        variable.array_dimensions, variable.value);
    if (!data_type) {
        return data_type;
    }
    const auto created = create(node, NodeClass::Variable);
    if (!created) {
        return created;
    }
    NodeRecord& record = tables_->record(*created);
    tables_->links(*created).type_definition = *type;
    record.data_type = *data_type;
    record.value_rank = variable.value_rank;
    record.access_level = static_cast<std::uint8_t>(variable.access_level);
    record.user_access_level =
        static_cast<std::uint8_t>(variable.access_level & variable.user_access_level);
    record.minimum_sampling_interval = variable.minimum_sampling_interval;
    record.flags = flag(variable.historizing, static_flag::historizing);
    record.source = variable.source;
    record.handle = variable.handle;
    busbar::detail::Undo undo{[&] { static_cast<void>(remove(*created)); }};
    if (!variable.array_dimensions.is_null()) {
        record.make_extra().array_dimensions = variable.array_dimensions;
    }
    if (!variable.value.is_null()) {
        record.make_extra().value = variable.value;
    }
    undo.keep();
    return created;
}

Result<NodeIndex> AddressSpace::add_variable(NodeIndex parent, const QualifiedName& name,
                                             const BoundValue& value, Access access)
{
    if (!exists(parent)) {
        return fail(status::Bad_ParentNodeIdInvalid);
    }
    const bool is_of_value = value.data_type.is_null();
    const NodeIndex type = is_of_value ? type_of_value(value.value) : find(value.data_type);
    if (type == no_node || value.value.is_null()) {
        return fail(status::Bad_NodeAttributesInvalid);
    }
    NewNode node;
    node.id = path_id(node_id(parent), name);
    node.browse_name = name;
    node.parent = parent;
    NewVariable variable;
    variable.data_type = is_of_value ? node_id(type) : value.data_type;
    set_shape(variable, value.value);
    variable.access_level = access;
    variable.source = value.source;
    variable.handle = value.handle;
    if (value.source == no_source) {
        variable.value = value.value;
    }
    return add_variable(node, variable);
}

Result<NodeIndex> AddressSpace::add_property(const NewNode& node, NewVariable variable)
{
    NewNode property = node;
    property.reference_type = NodeId{0, detail::id_has_property};
    variable.type_definition = NodeId{0, detail::id_property_type};
    return add_variable(property, variable);
}

Result<NodeIndex> AddressSpace::add_method(const NewNode& node, const NewMethod& method)
{
    for (const auto* const arguments : {&method.input_arguments, &method.output_arguments}) {
        if (const StatusCode bad = check_arguments(*this, *arguments); bad.is_bad()) {
            return fail(bad);
        }
    }
    NewNode as_component = node;
    if (node.reference_type.is_null()) {
        // A Method is called on the node whose component it is, even a folder (Part 4, 5.12.2.2).
        as_component.reference_type = NodeId{0, detail::id_has_component};
    }
    const auto created = create(as_component, NodeClass::Method);
    if (!created) {
        return created;
    }
    NodeRecord& record = tables_->record(*created);
    record.flags = flag(method.executable, static_flag::executable);
    record.source = method.source;
    record.handle = method.handle;
    busbar::detail::Undo undo{[&] { static_cast<void>(remove(*created)); }};
    if (const auto added = add_arguments(*created, method); !added) {
        return fail(added.error());
    }
    undo.keep();
    return created;
}

Result<void> AddressSpace::add_arguments(NodeIndex method, const NewMethod& from)
{
    const auto add = [&](const char* name, const Array<Argument>& arguments) -> Result<void> {
        if (arguments.empty()) {
            return {};
        }
        NewNode node;
        node.id = argument_id(*tables_, node_id(method));
        node.browse_name = QualifiedName{0, name};
        node.parent = method;
        const auto added = add_property(node, argument_property(arguments));
        return added ? Result<void>{} : fail(added.error());
    };
    const auto inputs = add("InputArguments", from.input_arguments);
    return inputs ? add("OutputArguments", from.output_arguments) : inputs;
}

Result<NodeIndex> AddressSpace::add_view(const NewNode& node, bool contains_no_loops)
{
    const auto created = create(node, NodeClass::View);
    if (created) {
        tables_->record(*created).flags = flag(contains_no_loops, static_flag::contains_no_loops);
    }
    return created;
}

Result<NodeIndex> AddressSpace::add_object_type(const NewNode& node, bool is_abstract)
{
    const auto created = create(node, NodeClass::ObjectType);
    if (created) {
        tables_->record(*created).flags = flag(is_abstract, static_flag::is_abstract);
    }
    return created;
}

Result<NodeIndex> AddressSpace::add_variable_type(const NewNode& node, const NewVariableType& type)
{
    const auto data_type =
        data_type_of(*this, type.data_type, type.value_rank, type.array_dimensions, type.value);
    if (!data_type) {
        return data_type;
    }
    const auto created = create(node, NodeClass::VariableType);
    if (created) {
        NodeRecord& record = tables_->record(*created);
        record.data_type = *data_type;
        record.value_rank = type.value_rank;
        record.flags = flag(type.is_abstract, static_flag::is_abstract);
        record.make_extra().array_dimensions = type.array_dimensions;
        record.make_extra().value = type.value;
    }
    return created;
}

Result<NodeIndex> AddressSpace::add_reference_type(const NewNode& node,
                                                   const NewReferenceType& type)
{
    const auto created = create(node, NodeClass::ReferenceType);
    if (created) {
        NodeRecord& record = tables_->record(*created);
        record.flags = static_cast<std::uint8_t>(flag(type.is_abstract, static_flag::is_abstract) |
                                                 flag(type.symmetric, static_flag::symmetric));
        record.make_extra().inverse_name = type.inverse_name;
    }
    return created;
}

Result<NodeIndex> AddressSpace::add_data_type(const NewNode& node, const NewDataType& type)
{
    const auto created = create(node, NodeClass::DataType);
    if (created) {
        NodeRecord& record = tables_->record(*created);
        record.flags = flag(type.is_abstract, static_flag::is_abstract);
        record.make_extra().definition = type.definition;
    }
    return created;
}

} // namespace busbar::model
