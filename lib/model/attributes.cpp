#include <busbar/model/space_reader.hpp>

#include <algorithm>

#include <busbar/binary/codec.hpp>

#include "tables.hpp"

namespace busbar::model {

using detail::Extra;
using detail::NodeRecord;
using detail::Overlay;
using detail::Tables;

namespace {

/// Returns a copy that borrows instead of owning.
String borrowed(const String& text)
{
    return text.is_null() ? String{} : String::borrow(text.view());
}

LocalizedText borrowed(const LocalizedText& text)
{
    return {borrowed(text.locale), borrowed(text.text)};
}

/// Returns null if the node has none.
String static_piece(const Tables& tables, NodeIndex node, StaticExtra::Kind kind)
{
    const auto extras = tables.constants->extras;
    const auto comes_before = [&](const StaticExtra& extra, std::uint32_t sought) {
        return extra.node < sought || (extra.node == sought && extra.kind < kind);
    };
    const auto found =
        std::lower_bound(extras.begin(), extras.end(), detail::number(node), comes_before);
    return found != extras.end() && found->node == detail::number(node) && found->kind == kind
               ? String::borrow(tables.text(found->text))
               : String{};
}

LocalizedText static_extra(const Tables& tables, NodeIndex node, StaticExtra::Kind text,
                           StaticExtra::Kind locale)
{
    String found = static_piece(tables, node, text);
    return found.is_null() ? LocalizedText{}
                           : LocalizedText{static_piece(tables, node, locale), std::move(found)};
}

Variant decoded(std::string_view bytes, const binary::TypeRegistry* types)
{
    binary::Reader reader{std::as_bytes(std::span{bytes.data(), bytes.size()}),
                          binary::Strings::Borrow, types};
    Variant value;
    decode(reader, value);
    return value;
}

constexpr unsigned bits(NodeClass node_class)
{
    return static_cast<unsigned>(node_class);
}

constexpr unsigned object = bits(NodeClass::Object);
constexpr unsigned variable_class = bits(NodeClass::Variable);
constexpr unsigned method = bits(NodeClass::Method);
constexpr unsigned object_type = bits(NodeClass::ObjectType);
constexpr unsigned variable_type = bits(NodeClass::VariableType);
constexpr unsigned reference_type = bits(NodeClass::ReferenceType);
constexpr unsigned data_type = bits(NodeClass::DataType);
constexpr unsigned view = bits(NodeClass::View);
constexpr unsigned all = 255;

/// The NodeClasses that have each attribute, by AttributeId (Part 3, table 9 and clause 5).
constexpr unsigned classes_with[] = {
    0,
    all,                                                      // NodeId
    all,                                                      // NodeClass
    all,                                                      // BrowseName
    all,                                                      // DisplayName
    all,                                                      // Description
    all,                                                      // WriteMask
    all,                                                      // UserWriteMask
    object_type | variable_type | reference_type | data_type, // IsAbstract
    reference_type,                                           // Symmetric
    reference_type,                                           // InverseName
    view,                                                     // ContainsNoLoops
    object | view,                                            // EventNotifier
    variable_class | variable_type,                           // Value
    variable_class | variable_type,                           // DataType
    variable_class | variable_type,                           // ValueRank
    variable_class | variable_type,                           // ArrayDimensions
    variable_class,                                           // AccessLevel
    variable_class,                                           // UserAccessLevel
    variable_class,                                           // MinimumSamplingInterval
    variable_class,                                           // Historizing
    method,                                                   // Executable
    method,                                                   // UserExecutable
    data_type,                                                // DataTypeDefinition
    all,                                                      // RolePermissions
    all,                                                      // UserRolePermissions
    all,                                                      // AccessRestrictions
    variable_class,                                           // AccessLevelEx
};

/// Returns a text that a node may have or not.
Result<Variant> if_present(LocalizedText text)
{
    if (text.text.is_null()) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    return Variant{std::move(text)};
}

struct Common {
    std::uint8_t flags;
    std::uint8_t event_notifier;

    [[nodiscard]] bool has(std::uint8_t flag) const { return (flags & flag) != 0; }
};

Common common(const Tables& tables, NodeIndex node)
{
    if (tables.is_constant(node)) {
        const StaticNode& constant = tables.constant(node);
        return {constant.flags, constant.event_notifier};
    }
    const NodeRecord& record = tables.record(node);
    return {record.flags, record.event_notifier};
}

LocalizedText description(const Tables& tables, NodeIndex node)
{
    if (!tables.is_constant(node)) {
        const Extra* const extra = tables.record(node).extra.get();
        return extra == nullptr ? LocalizedText{} : borrowed(extra->description);
    }
    const Overlay* const overlay = tables.overlay(node);
    return overlay != nullptr && !overlay->description.text.is_null()
               ? borrowed(overlay->description)
               : static_extra(tables, node, StaticExtra::Kind::Description,
                              StaticExtra::Kind::DescriptionLocale);
}

LocalizedText inverse_name(const Tables& tables, NodeIndex node)
{
    if (!tables.is_constant(node)) {
        const Extra* const extra = tables.record(node).extra.get();
        return extra == nullptr ? LocalizedText{} : borrowed(extra->inverse_name);
    }
    const StaticNode& constant = tables.constant(node);
    if (constant.details == no_details) {
        return {};
    }
    return {static_piece(tables, node, StaticExtra::Kind::InverseNameLocale),
            String::borrow(tables.text(tables.constants->texts[constant.details]))};
}

Result<Variant> definition(const Tables& tables, NodeIndex node)
{
    if (!tables.is_constant(node)) {
        const Extra* const extra = tables.record(node).extra.get();
        if (extra == nullptr || extra->definition.is_null()) {
            return fail(status::Bad_AttributeIdInvalid);
        }
        return Variant{extra->definition};
    }
    const StaticNode& constant = tables.constant(node);
    if (constant.details == no_details) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    const StaticText& at = tables.constants->texts[constant.details];
    Variant value = decoded(tables.constants->values.substr(at.offset, at.size), nullptr);
    if (value.is_null()) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    return value;
}

Array<std::uint32_t> dimensions(const VariableAttributes& attributes)
{
    if (!attributes.array_dimensions.empty()) {
        return Array<std::uint32_t>{attributes.array_dimensions};
    }
    Array<std::uint32_t> unknown;
    if (attributes.value_rank > 0) {
        // Each dimension has an unknown length (Part 3, 5.6.2).
        unknown.resize(static_cast<std::size_t>(attributes.value_rank));
    }
    return unknown;
}

} // namespace

bool SpaceReader::has_attribute(NodeClass node_class, AttributeId id)
{
    const auto index = static_cast<std::uint32_t>(id);
    return index < std::size(classes_with) && (classes_with[index] & bits(node_class)) != 0;
}

LocalizedText SpaceReader::display_name(NodeIndex node) const
{
    if (!tables_->is_constant(node)) {
        const NodeRecord& record = tables_->record(node);
        if (record.extra != nullptr && !record.extra->display_name.text.is_null()) {
            return borrowed(record.extra->display_name);
        }
        return LocalizedText{String::borrow(record.name(tables_->links(node)))};
    }
    if (!tables_->overlays.empty()) {
        const Overlay* const overlay = tables_->overlay(node);
        if (overlay != nullptr && !overlay->display_name.text.is_null()) {
            return borrowed(overlay->display_name);
        }
    }
    LocalizedText text = static_extra(*tables_, node, StaticExtra::Kind::DisplayName,
                                      StaticExtra::Kind::DisplayNameLocale);
    return text.text.is_null() ? LocalizedText{browse_name(node).name} : std::move(text);
}

VariableAttributes SpaceReader::variable(NodeIndex node) const
{
    VariableAttributes result;
    if (!has_attribute(node_class(node), AttributeId::Value)) {
        return result;
    }
    if (!tables_->is_constant(node)) {
        const NodeRecord& record = tables_->record(node);
        result.data_type = record.data_type;
        result.value_rank = record.value_rank;
        result.minimum_sampling_interval = record.minimum_sampling_interval;
        result.access_level = record.access_level;
        result.user_access_level = record.user_access_level;
        result.historizing = (record.flags & static_flag::historizing) != 0;
        result.source = record.source;
        result.handle = record.handle;
        if (record.extra != nullptr) {
            result.array_dimensions = record.extra->array_dimensions.span();
        }
        return result;
    }
    const StaticNode& constant = tables_->constant(node);
    const StaticVariable& from = tables_->constants->variables[constant.details];
    result.data_type = tables_->target(from.data_type);
    result.value_rank = from.value_rank;
    result.array_dimensions = tables_->constants->dimensions.subspan(from.array_dimensions.offset,
                                                                     from.array_dimensions.size);
    result.minimum_sampling_interval = from.minimum_sampling_interval;
    result.access_level = result.user_access_level = from.access_level;
    result.historizing = (constant.flags & static_flag::historizing) != 0;
    if (const Overlay* const overlay = tables_->overlay(node)) {
        result.source = overlay->source;
        result.handle = overlay->handle;
        if (overlay->has_access_level) {
            result.access_level = overlay->access_level;
            result.user_access_level = overlay->user_access_level;
        }
    }
    return result;
}

MethodAttributes SpaceReader::method(NodeIndex node) const
{
    if (node_class(node) != NodeClass::Method) {
        return {};
    }
    MethodAttributes result;
    result.executable = common(*tables_, node).has(static_flag::executable);
    if (!tables_->is_constant(node)) {
        const NodeRecord& record = tables_->record(node);
        result.source = record.source;
        result.handle = record.handle;
    } else if (const Overlay* const overlay = tables_->overlay(node)) {
        result.executable = overlay->has_executable ? overlay->executable : result.executable;
        result.source = overlay->source;
        result.handle = overlay->handle;
    }
    return result;
}

NodeId SpaceReader::data_type_id(NodeIndex node) const
{
    const NodeIndex type = variable(node).data_type;
    if (type != no_node) {
        return node_id(type);
    }
    if (!tables_->is_constant(node) || !has_attribute(node_class(node), AttributeId::Value)) {
        return {};
    }
    const StaticVariable& from = tables_->constants->variables[tables_->constant(node).details];
    return NodeId{0, tables_->constants->externals[from.data_type - tables_->constant_count].value};
}

DataValue SpaceReader::data_value(NodeIndex node) const
{
    DataValue result{value(node)};
    const detail::ValueQuality* quality = nullptr;
    if (!tables_->is_constant(node)) {
        const Extra* const extra = tables_->record(node).extra.get();
        quality = extra != nullptr ? &extra->quality : nullptr;
    } else if (const Overlay* const overlay = tables_->overlay(node)) {
        quality = &overlay->quality;
    }
    if (quality != nullptr) {
        result.status = quality->status;
        result.source_timestamp = quality->source_timestamp;
        result.source_picoseconds = quality->source_picoseconds;
    }
    return result;
}

Variant SpaceReader::value(NodeIndex node, const binary::TypeRegistry* types) const
{
    if (!has_attribute(node_class(node), AttributeId::Value)) {
        return {};
    }
    if (!tables_->is_constant(node)) {
        const Extra* const extra = tables_->record(node).extra.get();
        return extra == nullptr ? Variant{} : extra->value;
    }
    const Overlay* const overlay = tables_->overlay(node);
    if (overlay != nullptr && overlay->has_value) {
        return overlay->value;
    }
    const StaticText& at = tables_->constants->variables[tables_->constant(node).details].value;
    return at.size == 0 ? Variant{}
                        : decoded(tables_->constants->values.substr(at.offset, at.size), types);
}

bool SpaceReader::is_abstract(NodeIndex node) const
{
    return common(*tables_, node).has(static_flag::is_abstract);
}

Result<Variant> SpaceReader::attribute(NodeIndex node, AttributeId id) const
{
    if (!has_attribute(node_class(node), id)) {
        return fail(status::Bad_AttributeIdInvalid);
    }
    const Common flags = common(*tables_, node);
    switch (id) {
    case AttributeId::NodeId:
        return Variant{node_id(node)};
    case AttributeId::NodeClass:
        return Variant{node_class(node)};
    case AttributeId::BrowseName:
        return Variant{browse_name(node)};
    case AttributeId::DisplayName:
        return Variant{display_name(node)};
    case AttributeId::Description:
        return if_present(description(*tables_, node));
    case AttributeId::UserWriteMask:
        // A server determines the rights of a user.
        return Variant{std::uint32_t{0}};
    case AttributeId::IsAbstract:
        return Variant{flags.has(static_flag::is_abstract)};
    case AttributeId::Symmetric:
        return Variant{flags.has(static_flag::symmetric)};
    case AttributeId::InverseName:
        return if_present(inverse_name(*tables_, node));
    case AttributeId::ContainsNoLoops:
        return Variant{flags.has(static_flag::contains_no_loops)};
    case AttributeId::EventNotifier:
        return Variant{flags.event_notifier};
    case AttributeId::Executable:
    case AttributeId::UserExecutable:
        return Variant{method(node).executable};
    case AttributeId::DataTypeDefinition:
        return definition(*tables_, node);
    default:
        return variable_attribute(node, id);
    }
}

Result<Variant> SpaceReader::variable_attribute(NodeIndex node, AttributeId id) const
{
    const VariableAttributes attributes = variable(node);
    switch (id) {
    case AttributeId::DataType:
        return Variant{data_type_id(node)};
    case AttributeId::ValueRank:
        return Variant{attributes.value_rank};
    case AttributeId::ArrayDimensions:
        return Variant{dimensions(attributes)};
    case AttributeId::AccessLevel:
        return Variant{attributes.access_level};
    case AttributeId::UserAccessLevel:
        return Variant{attributes.user_access_level};
    case AttributeId::MinimumSamplingInterval:
        return Variant{attributes.minimum_sampling_interval};
    case AttributeId::Historizing:
        return Variant{attributes.historizing};
    default:
        // UserRolePermissions depend on the session; Value is not read here.
        return access_attribute(node, id);
    }
}

} // namespace busbar::model
