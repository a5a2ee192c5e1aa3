#include "instantiation.hpp"

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model::detail {

namespace {

/// True if a Variable of `rank` may have a type of `type_rank` (Part 3, 5.6.5).
bool rank_is_within(std::int32_t rank, std::int32_t type_rank)
{
    switch (type_rank) {
    case -2: // Any
        return true;
    case -3: // ScalarOrOneDimension
        return rank == -3 || rank == -1 || rank == 1;
    case 0: // OneOrMoreDimensions
        return rank >= 0;
    default:
        return rank == type_rank;
    }
}

NewVariable variable_like(const SpaceReader& space, NodeIndex like)
{
    const VariableAttributes attributes = space.variable(like);
    NewVariable variable;
    variable.data_type = space.data_type_id(like);
    variable.value_rank = attributes.value_rank;
    if (!attributes.array_dimensions.empty()) {
        variable.array_dimensions = Array<std::uint32_t>{attributes.array_dimensions};
    }
    variable.value = space.value(like);
    if (space.node_class(like) == NodeClass::Variable) {
        variable.access_level = Access{attributes.access_level};
        variable.user_access_level = Access{attributes.user_access_level};
        variable.minimum_sampling_interval = attributes.minimum_sampling_interval;
        variable.historizing = attributes.historizing;
    }
    return variable;
}

/// Copies the declaration's texts if they differ from its BrowseName.
void copy_texts(const SpaceReader& space, NodeIndex from, NewNode& to)
{
    const LocalizedText name = space.display_name(from);
    if (name.text != space.browse_name(from).name || !name.locale.empty()) {
        to.display_name = name;
    }
    if (const auto description = space.attribute(from, AttributeId::Description)) {
        if (const auto* const text = description->get_if<LocalizedText>()) {
            to.description = *text;
        }
    }
}

void copy_further_texts(AddressSpace& space, NodeIndex from, NodeIndex to)
{
    for (const AttributeId attribute : {AttributeId::DisplayName, AttributeId::Description}) {
        const std::vector<LocalizedText> texts = space.texts(from, attribute);
        for (std::size_t i = 1; i < texts.size(); ++i) {
            static_cast<void>(space.set_text(to, attribute, Variant{texts[i]}));
        }
    }
}

std::uint8_t event_notifier_of(const SpaceReader& space, NodeIndex object)
{
    const auto value = space.attribute(object, AttributeId::EventNotifier);
    const auto* const byte = value ? value->get_if<std::uint8_t>() : nullptr;
    return byte == nullptr ? std::uint8_t{0} : *byte;
}

} // namespace

Result<NodeIndex> Instantiation::create_root(const NewNode& node, NodeIndex type)
{
    if (!space_.exists(type) || space_.is_abstract(type)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    switch (space_.node_class(type)) {
    case NodeClass::ObjectType:
        return space_.add_object(node, {space_.node_id(type), options_.event_notifier});
    case NodeClass::VariableType:
        return create_variable(node, type);
    default:
        return fail(status::Bad_TypeDefinitionInvalid);
    }
}

Result<NodeIndex> Instantiation::create_variable(const NewNode& node, NodeIndex type)
{
    NewVariable variable = options_.variable ? *options_.variable : variable_like(space_, type);
    variable.type_definition = space_.node_id(type);
    const VariableAttributes allowed = space_.variable(type);
    const NodeIndex data_type = space_.find(variable.data_type);
    // Part 3, 5.6.5: a Variable's DataType and ValueRank are equal to or narrower than those of its
    // type.
    const bool fits =
        rank_is_within(variable.value_rank, allowed.value_rank) &&
        (allowed.data_type == no_node || space_.is_subtype_of(data_type, allowed.data_type));
    return fits ? space_.add_variable(node, variable) : fail(status::Bad_NodeAttributesInvalid);
}

/// Creates the declared member below `parent`, or shares a Method.
Result<NodeIndex> Instantiation::copy(NodeIndex parent, const DeclaredMember& member,
                                      const std::string& path)
{
    const NodeIndex declaration = member.declaration();
    const bool is_method = space_.node_class(declaration) == NodeClass::Method;
    if (is_method && options_.methods == InstanceMethods::Shared) {
        const auto shared = reference(parent, member.reference_type, declaration);
        return shared ? Result<NodeIndex>{declaration} : fail(shared.error());
    }
    const NodeIndex type = is_method ? no_node : type_of(declaration, path);
    if (!is_method && (type == no_node || space_.is_abstract(type))) {
        if (options_.fault != nullptr) {
            *options_.fault = {path, space_.node_id(space_.type_definition(declaration))};
        }
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    NodeIndex created = no_node;
    Result<void> done = copy_node(parent, declaration, type, member.reference_type, created);
    if (done && is_method) {
        done = copy_arguments(created, member);
    }
    return done ? Result<NodeIndex>{created} : fail(done.error());
}

NodeIndex Instantiation::type_of(NodeIndex declaration, const std::string& path) const
{
    const NodeIndex declared = space_.type_definition(declaration);
    for (const auto& [sought, type] : options_.types) {
        if (sought == path) {
            const NodeIndex chosen = space_.find(type);
            return space_.is_subtype_of(chosen, declared) ? chosen : no_node;
        }
    }
    return declared;
}

/// Returns false for a member of an abstract type for which the caller chose no other.
bool Instantiation::can_be_made(const DeclaredMember& member, const std::string& path) const
{
    if (space_.node_class(member.declaration()) == NodeClass::Method) {
        return true;
    }
    const NodeIndex type = type_of(member.declaration(), path);
    return type != no_node && !space_.is_abstract(type);
}

Result<void> Instantiation::copy_node(NodeIndex parent, NodeIndex declaration, NodeIndex type,
                                      NodeIndex reference_type, NodeIndex& created)
{
    if (created_.size() >= options_.limits.max_nodes) {
        return fail(status::Bad_TooManyOperations);
    }
    NewNode node;
    node.browse_name = space_.browse_name(declaration);
    node.id = id_below(space_, parent, node.browse_name, options_.ids);
    node.parent = parent;
    node.reference_type = space_.node_id(reference_type);
    copy_texts(space_, declaration, node);
    Result<NodeIndex> added = fail(status::Bad_NodeClassInvalid);
    switch (space_.node_class(declaration)) {
    case NodeClass::Object:
        added =
            space_.add_object(node, {space_.node_id(type), event_notifier_of(space_, declaration)});
        break;
    case NodeClass::Variable: {
        NewVariable variable = variable_like(space_, declaration);
        variable.type_definition = space_.node_id(type);
        added = space_.add_variable(node, variable);
        break;
    }
    case NodeClass::Method: {
        const MethodAttributes method = space_.method(declaration);
        added = space_.add_method(node, {method.executable, {}, {}, method.source, method.handle});
        break;
    }
    default:
        break;
    }
    if (!added) {
        return fail(added.error());
    }
    created = *added;
    busbar::detail::Undo undone{[&] { static_cast<void>(space_.remove(created)); }};
    if (const NodeAccess* const access = space_.node_access(declaration)) {
        space_.set_node_access(created, NodeAccess{*access});
    }
    if (space_.has_further_texts(declaration)) {
        copy_further_texts(space_, declaration, created);
    }
    undone.keep();
    return note_created(created);
}

Result<void> Instantiation::note_created(NodeIndex node)
{
    busbar::detail::Undo undone{[&] { static_cast<void>(space_.remove(node)); }};
    created_.push_back(node);
    undone.keep();
    const bool is_limited = options_.limits.max_memory != SIZE_MAX;
    return is_limited ? charge(memory_of(space_, node)) : Result<void>{};
}

Result<void> Instantiation::charge(std::size_t bytes)
{
    memory_ += bytes;
    return memory_ > options_.limits.max_memory ? fail(status::Bad_TooManyOperations)
                                                : Result<void>{};
}

/// The properties of a Method belong to its signature, whatever rule they have.
Result<void> Instantiation::copy_arguments(NodeIndex method, const DeclaredMember& member)
{
    ReferenceCursor cursor = space_.references(member.declaration());
    std::vector<NodeIndex> properties;
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && space_.is_subtype_of(reference->type, id::HasProperty)) {
            properties.push_back(reference->target);
        }
    }
    for (const NodeIndex property : properties) {
        NodeIndex created = no_node;
        if (auto done = copy_node(method, property, space_.find(id::PropertyType),
                                  space_.find(id::HasProperty), created);
            !done) {
            return done;
        }
    }
    return {};
}

NodeId id_below(AddressSpace& space, NodeIndex parent, const QualifiedName& name, InstanceIds ids)
{
    const NodeId above = space.node_id(parent);
    if (ids == InstanceIds::Path && above.id_type() == IdType::String) {
        return NodeId{above.namespace_index(), above.string().str() + '/' + name.name.str()};
    }
    return space.free_id(above.namespace_index());
}

NewNode child_node(AddressSpace& space, NodeIndex parent, const QualifiedName& name)
{
    NewNode node;
    node.id = id_below(space, parent, name, InstanceIds::Path);
    node.browse_name = name;
    node.parent = parent;
    return node;
}

Result<NodeIndex> optional_member(AddressSpace& space, NodeIndex instance, const char* name)
{
    if (const NodeIndex found = find_by_path(space, instance, name); found != no_node) {
        return found;
    }
    InstanceOptions options;
    options.optional.emplace_back(name);
    if (auto added = add_optional(space, instance, options); !added) {
        return fail(added.error());
    }
    return find_by_path(space, instance, name);
}

/// Copies the references between InstanceDeclarations that are not hierarchical, as Part 3, 6.4.4.1
/// allows.
Result<void> Instantiation::add_other_references()
{
    for (const auto& [declaration, instance] : instances_) {
        ReferenceCursor cursor = space_.references(declaration.node);
        std::vector<Reference> found;
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                !space_.is_subtype_of(reference->type, id::HierarchicalReferences)) {
                found.push_back(*reference);
            }
        }
        for (const Reference& other : found) {
            const auto target = instances_.find({other.target, declaration.scope});
            const bool is_shared = instance == declaration.node;
            if (target == instances_.end() || is_shared) {
                continue;
            }
            if (auto added = reference(instance, other.type, target->second); !added) {
                return added;
            }
        }
    }
    return {};
}

/// Adds the reference unless it exists.
Result<void> Instantiation::reference(NodeIndex source, NodeIndex type, NodeIndex target)
{
    const NodeId type_id = space_.node_id(type);
    const auto added = space_.add_reference(source, type_id, target);
    if (added) {
        busbar::detail::Undo undone{
            [&] { static_cast<void>(space_.remove_reference(source, type_id, target)); }};
        references_.push_back({source, type_id, target});
        undone.keep();
        return charge(bytes_per_reference);
    }
    if (added.error() != status::Bad_DuplicateReferenceNotAllowed) {
        return added;
    }
    return {};
}

void Instantiation::undo()
{
    for (auto at = references_.rbegin(); at != references_.rend(); ++at) {
        static_cast<void>(space_.remove_reference(at->source, at->type, at->target));
    }
    references_.clear();
    for (auto at = created_.rbegin(); at != created_.rend(); ++at) {
        static_cast<void>(space_.remove(*at));
    }
    created_.clear();
}

} // namespace busbar::model::detail
