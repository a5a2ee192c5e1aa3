#include <busbar/model/address_space.hpp>

#include <busbar/binary/codec.hpp>

#include "graft.hpp"
#include "namespace_map.hpp"

namespace busbar::model {

using detail::NodeRecord;

namespace {

/// Copies the nodes of one StaticNodes into an AddressSpace.
class StaticCopy {
public:
    StaticCopy(AddressSpace& space, const StaticNodes& nodes)
        : space_{space}, graft_{space}, from_{nodes}
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
    void find_externals();
    [[nodiscard]] Result<void> create_nodes();
    void set_details(const StaticNode& node, NodeRecord& record);
    void set_variable(const StaticVariable& variable, NodeRecord& record);
    [[nodiscard]] Variant value(const StaticText& at) const;
    [[nodiscard]] bool has_other_namespaces() const;
    void map_values();
    void set_texts();
    void set_access();
    void add_references(std::uint32_t index);

    /// Returns a node of this copy, or an external one.
    [[nodiscard]] NodeIndex target(std::uint32_t index) const
    {
        const auto& created = graft_.created();
        return index < created.size() ? created[index] : externals_[index - created.size()];
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
    detail::Graft graft_;
    const StaticNodes& from_;
    std::vector<std::uint16_t> namespaces_;
    std::vector<NodeIndex> externals_;
};

Result<void> StaticCopy::run()
{
    if (auto mapped = map_namespaces(); !mapped) {
        return mapped;
    }
    find_externals();
    if (auto created = create_nodes(); !created) {
        return created;
    }
    set_texts();
    for (std::uint32_t i = 0; i < from_.nodes.size(); ++i) {
        add_references(i);
    }
    set_access();
    graft_.link();
    if (has_other_namespaces()) {
        map_values();
    }
    graft_.keep();
    return {};
}

Result<void> StaticCopy::map_namespaces()
{
    for (const StaticText& uri : from_.namespaces) {
        const auto index = graft_.add_namespace(text(uri));
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

void StaticCopy::find_externals()
{
    for (const StaticIdentifier& external : from_.externals) {
        const auto id = node_id(external);
        // A small namespace 0 lacks nodes; references to them are left out.
        externals_.push_back(id ? space_.find(*id) : no_node);
    }
}

Result<void> StaticCopy::create_nodes()
{
    graft_.reserve(from_.nodes.size());
    for (const StaticNode& node : from_.nodes) {
        const QualifiedName name{namespaces_[node.browse_namespace],
                                 String::borrow(text(node.browse_name))};
        const auto id = node_id(node.id);
        const auto created =
            id ? graft_.create(*id, name, NodeClass{node.node_class}) : fail(id.error());
        if (!created) {
            return fail(created.error());
        }
    }
    for (std::size_t i = 0; i < from_.nodes.size(); ++i) {
        set_details(from_.nodes[i], graft_.record(graft_.created()[i]));
    }
    return {};
}

/// Returns the value with the namespace indices of the tables.
Variant StaticCopy::value(const StaticText& at) const
{
    const std::string_view bytes = from_.values.substr(at.offset, at.size);
    binary::Reader reader{std::as_bytes(std::span{bytes.data(), bytes.size()})};
    Variant value;
    decode(reader, value);
    return value;
}

bool StaticCopy::has_other_namespaces() const
{
    for (std::size_t i = 0; i < namespaces_.size(); ++i) {
        if (namespaces_[i] != i) {
            return true;
        }
    }
    return false;
}

/// Sets this server's namespace indices in values. Structures are read by the definitions of their
/// types, which may be among these nodes: they must have been linked.
void StaticCopy::map_values()
{
    const detail::StructureBodies bodies{space_};
    for (std::size_t i = 0; i < from_.nodes.size(); ++i) {
        const StaticNode& node = from_.nodes[i];
        const auto node_class = NodeClass{node.node_class};
        if ((node_class == NodeClass::Variable || node_class == NodeClass::VariableType) &&
            node.details != no_details && from_.variables[node.details].value.size != 0) {
            detail::Extra& extra = graft_.record(graft_.created()[i]).make_extra();
            detail::map_namespaces(extra.value, namespaces_, &bodies);
        }
    }
}

void StaticCopy::set_details(const StaticNode& node, NodeRecord& record)
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
        Variant decoded = value(from_.texts[node.details]);
        detail::map_namespaces(decoded, namespaces_);
        if (const auto* const definition = decoded.get_if<ExtensionObject>()) {
            record.make_extra().definition = *definition;
        }
        break;
    }
    default:
        break;
    }
}

void StaticCopy::set_variable(const StaticVariable& variable, NodeRecord& record)
{
    record.data_type = target(variable.data_type);
    if (record.data_type == no_node) {
        record.data_type = space_.find(detail::id_base_data_type);
    }
    record.value_rank = variable.value_rank;
    record.minimum_sampling_interval = variable.minimum_sampling_interval;
    record.access_level = record.user_access_level = variable.access_level;
    if (variable.array_dimensions.size != 0) {
        record.make_extra().array_dimensions = Array<std::uint32_t>{from_.dimensions.subspan(
            variable.array_dimensions.offset, variable.array_dimensions.size)};
    }
    if (variable.value.size != 0) {
        record.make_extra().value = value(variable.value);
    }
}

void StaticCopy::set_texts()
{
    for (const StaticExtra& extra : from_.extras) {
        detail::Extra& to = graft_.record(graft_.created()[extra.node]).make_extra();
        String found{text(extra.text)};
        switch (extra.kind) {
        case StaticExtra::Kind::DisplayName:
            to.display_name.text = std::move(found);
            break;
        case StaticExtra::Kind::Description:
            to.description.text = std::move(found);
            break;
        case StaticExtra::Kind::DisplayNameLocale:
            to.display_name.locale = std::move(found);
            break;
        case StaticExtra::Kind::DescriptionLocale:
            to.description.locale = std::move(found);
            break;
        case StaticExtra::Kind::InverseNameLocale:
            to.inverse_name.locale = std::move(found);
            break;
        }
    }
}

void StaticCopy::set_access()
{
    for (const StaticAccess& each : from_.access) {
        graft_.set_access(graft_.created()[each.node],
                          detail::node_access(from_, each, namespaces_));
    }
    if (from_.restrictions != 0 && !from_.nodes.empty()) {
        space_.set_namespace_restrictions(namespaces_[from_.nodes[0].id.namespace_index],
                                          from_.restrictions);
    }
}

void StaticCopy::add_references(std::uint32_t index)
{
    const NodeIndex node = graft_.created()[index];
    for (const StaticReference& reference : references(index)) {
        const NodeIndex type = target(from_.reference_types[reference.type()]);
        const NodeIndex other = target(reference.target());
        if (type != no_node && other != no_node) {
            graft_.add_reference(reference.is_forward() ? node : other, type,
                                 reference.is_forward() ? other : node);
        }
    }
}

} // namespace

Result<void> AddressSpace::add(const StaticNodes& nodes)
{
    return StaticCopy{*this, nodes}.run();
}

} // namespace busbar::model
