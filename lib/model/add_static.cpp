#include <busbar/model/address_space.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/types/data_types.hpp>

#include "tables.hpp"

namespace busbar::model {

using detail::Entry;
using detail::Record;
using detail::Tables;

namespace {

/// Copies the nodes of one StaticNodes into an AddressSpace.
class StaticCopy {
public:
    StaticCopy(AddressSpace& space, Tables& tables, const StaticNodes& nodes)
        : space_{space}, tables_{tables}, from_{nodes}
    {
    }

    [[nodiscard]] Result<void> run();

private:
    [[nodiscard]] std::string_view text(const StaticText& at) const
    {
        return from_.text.substr(at.offset, at.size);
    }
    [[nodiscard]] Result<NodeId> node_id(const StaticIdentifier& id) const;
    [[nodiscard]] Result<void> map_namespaces();
    [[nodiscard]] Result<void> find_externals();
    [[nodiscard]] Result<void> check_ids() const;
    void create_nodes();
    void map(NodeId& id) const;
    [[nodiscard]] ExtensionObject mapped(const ExtensionObject& definition) const;
    void set_details(const StaticNode& node, Record& record);
    void set_variable(const StaticVariable& variable, Record& record);
    void set_texts();
    void link(std::uint32_t index);
    [[nodiscard]] NodeIndex choose_parent(std::uint32_t index, StaticReference& chosen) const;
    [[nodiscard]] bool is_above(NodeIndex node, NodeIndex other) const;
    [[nodiscard]] bool is_parent_link(const Reference& reference, NodeIndex source) const;
    void add_references(std::uint32_t index);

    /// A node of this copy, or an external one.
    [[nodiscard]] NodeIndex target(std::uint32_t index) const
    {
        return index < created_.size() ? created_[index] : externals_[index - created_.size()];
    }
    [[nodiscard]] Reference resolve(StaticReference reference) const
    {
        return {target(from_.reference_types[reference.type()]), target(reference.target()),
                reference.is_forward()};
    }
    [[nodiscard]] std::span<const StaticReference> references(std::uint32_t index) const
    {
        const std::size_t first = from_.nodes[index].first_reference;
        const std::size_t last = index + std::size_t{1} < from_.nodes.size()
                                     ? from_.nodes[index + 1].first_reference
                                     : from_.references.size();
        return from_.references.subspan(first, last - first);
    }

    AddressSpace& space_;
    Tables& tables_;
    const StaticNodes& from_;
    std::vector<std::uint16_t> namespaces_;
    std::vector<NodeIndex> externals_;
    std::vector<NodeIndex> created_;
};

Variant decoded(std::string_view bytes)
{
    binary::Reader reader{std::as_bytes(std::span{bytes.data(), bytes.size()})};
    Variant value;
    decode(reader, value);
    return value;
}

Result<void> StaticCopy::run()
{
    if (auto mapped = map_namespaces(); !mapped) {
        return mapped;
    }
    if (auto found = find_externals(); !found) {
        return found;
    }
    if (auto checked = check_ids(); !checked) {
        return checked;
    }
    create_nodes();
    set_texts();
    for (std::uint32_t i = 0; i < from_.nodes.size(); ++i) {
        link(i);
    }
    for (std::uint32_t i = 0; i < from_.nodes.size(); ++i) {
        add_references(i);
    }
    return {};
}

Result<void> StaticCopy::map_namespaces()
{
    for (const StaticText& uri : from_.namespaces) {
        const auto index = space_.add_namespace(text(uri));
        if (!index) {
            return fail(index.error());
        }
        namespaces_.push_back(*index);
    }
    return {};
}

Result<NodeId> StaticCopy::node_id(const StaticIdentifier& id) const
{
    const std::uint16_t mapped = namespaces_[id.namespace_index];
    if (id.kind == StaticIdKind::Numeric) {
        return NodeId{mapped, id.value};
    }
    auto parsed = NodeId::parse(text(from_.texts[id.value]));
    if (parsed) {
        parsed->set_namespace_index(mapped);
    }
    return parsed;
}

Result<void> StaticCopy::find_externals()
{
    for (const StaticIdentifier& external : from_.externals) {
        const auto id = node_id(external);
        // A small namespace 0 lacks nodes; whatever refers to them is left out.
        externals_.push_back(id ? space_.find(*id) : no_node);
    }
    return {};
}

Result<void> StaticCopy::check_ids() const
{
    if (tables_.record_count + from_.nodes.size() >= detail::IndexTable::max_records) {
        return fail(status::Bad_OutOfMemory);
    }
    for (const StaticNode& node : from_.nodes) {
        const auto id = node_id(node.id);
        if (!id || space_.find(*id) != no_node) {
            return fail(id ? status::Bad_NodeIdExists : id.error());
        }
    }
    return {};
}

void StaticCopy::create_nodes()
{
    created_.reserve(from_.nodes.size());
    space_.reserve(from_.nodes.size());
    for (const StaticNode& node : from_.nodes) {
        const QualifiedName name{namespaces_[node.browse_namespace],
                                 String::borrow(text(node.browse_name))};
        created_.push_back(
            tables_.create(node_id(node.id).value_or(NodeId{}), name, NodeClass{node.node_class}));
    }
    for (std::size_t i = 0; i < created_.size(); ++i) {
        set_details(from_.nodes[i], tables_.record(created_[i]));
    }
}

void StaticCopy::map(NodeId& id) const
{
    if (id.namespace_index() < namespaces_.size()) {
        id.set_namespace_index(namespaces_[id.namespace_index()]);
    }
}

/// A StructureDefinition names types and encodings, which have other namespace indices here.
ExtensionObject StaticCopy::mapped(const ExtensionObject& object) const
{
    auto definition = binary::from_bytes<StructureDefinition>(object.binary().span());
    if (!object.encoding_id().is(StructureDefinition::binary_encoding_id) || !definition) {
        return object;
    }
    map(definition->default_encoding_id);
    map(definition->base_data_type);
    for (StructureField& field : definition->fields) {
        map(field.data_type);
    }
    return ExtensionObject::from(std::move(*definition));
}

void StaticCopy::set_details(const StaticNode& node, Record& record)
{
    record.flags = node.flags;
    record.event_notifier = node.event_notifier;
    if (node.details == no_details) {
        return;
    }
    switch (record.node_class()) {
    case NodeClass::Variable:
    case NodeClass::VariableType:
        set_variable(from_.variables[node.details], record);
        break;
    case NodeClass::ReferenceType:
        record.make_extra().inverse_name = LocalizedText{String{text(from_.texts[node.details])}};
        break;
    case NodeClass::DataType: {
        const StaticText& at = from_.texts[node.details];
        const Variant value = decoded(from_.values.substr(at.offset, at.size));
        if (const auto* const definition = value.get_if<ExtensionObject>()) {
            record.make_extra().definition = mapped(*definition);
        }
        break;
    }
    default:
        break;
    }
}

void StaticCopy::set_variable(const StaticVariable& variable, Record& record)
{
    record.data_type = target(variable.data_type);
    if (record.data_type == no_node) {
        record.data_type = tables_.find_constant(detail::id_base_data_type);
    }
    record.value_rank = variable.value_rank;
    record.minimum_sampling_interval = static_cast<double>(variable.minimum_sampling_interval);
    record.access_level = record.user_access_level = variable.access_level;
    if (variable.array_dimensions.size != 0) {
        record.make_extra().array_dimensions = Array<std::uint32_t>{from_.dimensions.subspan(
            variable.array_dimensions.offset, variable.array_dimensions.size)};
    }
    if (variable.value.size != 0) {
        record.make_extra().value =
            decoded(from_.values.substr(variable.value.offset, variable.value.size));
    }
}

void StaticCopy::set_texts()
{
    for (const StaticExtra& extra : from_.extras) {
        detail::Extra& to = tables_.record(created_[extra.node]).make_extra();
        LocalizedText& place =
            extra.kind == StaticExtra::Kind::DisplayName ? to.display_name : to.description;
        place = LocalizedText{String{text(extra.text)}};
    }
}

bool StaticCopy::is_above(NodeIndex node, NodeIndex other) const
{
    NodeIndex at = other;
    while (at != no_node && at != node) {
        at = tables_.is_constant(at) ? no_node : tables_.record(at).parent;
    }
    return at == node;
}

/// The source of the first hierarchical reference to the node; of a type, its supertype.
NodeIndex StaticCopy::choose_parent(std::uint32_t index, StaticReference& chosen) const
{
    const bool is_type = index < from_.types.size();
    for (const StaticReference& reference : references(index)) {
        const Reference resolved = resolve(reference);
        if (resolved.is_forward || resolved.target == no_node ||
            (is_type ? resolved.type != tables_.has_subtype
                     : !space_.is_subtype_of(resolved.type, detail::id_hierarchical_references))) {
            continue;
        }
        if (!is_above(created_[index], resolved.target)) {
            chosen = reference;
            return resolved.target;
        }
    }
    return no_node;
}

void StaticCopy::link(std::uint32_t index)
{
    const NodeIndex node = created_[index];
    StaticReference chosen;
    const NodeIndex parent = choose_parent(index, chosen);
    if (parent != no_node) {
        tables_.link(parent, resolve(chosen).type, node);
    }
    if (index < from_.types.size()) {
        tables_.place_type(node, parent);
    }
    for (const StaticReference& reference : references(index)) {
        const Reference resolved = resolve(reference);
        if (resolved.is_forward && resolved.type == tables_.has_type_definition) {
            tables_.record(node).type_definition = resolved.target;
        }
    }
}

/// True if the reference is the one that `link` made, seen from either end.
bool StaticCopy::is_parent_link(const Reference& reference, NodeIndex source) const
{
    const NodeIndex child = reference.is_forward ? reference.target : source;
    const NodeIndex parent = reference.is_forward ? source : reference.target;
    return !tables_.is_constant(child) && tables_.record(child).parent == parent &&
           tables_.record(child).parent_reference == reference.type;
}

void StaticCopy::add_references(std::uint32_t index)
{
    const NodeIndex node = created_[index];
    const NodeIndex has_modelling_rule = tables_.find_constant(detail::id_has_modelling_rule);
    for (const StaticReference& from : references(index)) {
        const Reference reference = resolve(from);
        const bool is_own = from.target() < created_.size();
        if (reference.type == no_node || reference.target == no_node ||
            reference.type == tables_.has_type_definition || is_parent_link(reference, node)) {
            continue;
        }
        // One between two nodes of the copy is listed at both; one that leads out only here.
        tables_.add_entry(node, Entry{reference.type, reference.target, reference.is_forward});
        if (!is_own && reference.type != has_modelling_rule) {
            tables_.add_entry(reference.target, Entry{reference.type, node, !reference.is_forward});
        }
    }
}

} // namespace

Result<void> AddressSpace::add(const StaticNodes& nodes)
{
    return StaticCopy{*this, *tables_, nodes}.run();
}

} // namespace busbar::model
