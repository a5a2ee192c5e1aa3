#include "node_attributes.hpp"

#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

namespace {

using Mask = NodeAttributesMask;

/// Bits of AccessLevelType and EventNotifierType that concern history.
constexpr unsigned history_bits = 4U | 8U;

template <typename T>
bool take(const Variant& value, std::optional<T>& to)
{
    const T* const given = value.get_if<T>();
    if (given == nullptr || to) {
        return false;
    }
    to = *given;
    return true;
}

bool take(const Variant& value, LocalizedText& to)
{
    const auto* const given = value.get_if<LocalizedText>();
    if (given != nullptr) {
        to = *given;
    }
    return given != nullptr;
}

bool take_dimensions(const Variant& value, std::optional<Array<std::uint32_t>>& to)
{
    const auto* const given = value.array_if<std::uint32_t>();
    if ((given == nullptr && !value.is_null()) || to) {
        return false;
    }
    to = given == nullptr ? Array<std::uint32_t>{} : *given;
    return true;
}

/// Accepts only bits that do not concern history.
bool take_bits(const Variant& value, std::optional<std::uint8_t>& to)
{
    return take(value, to) && (*to & history_bits) == 0;
}

/// Accepts an attribute only with the value that means nothing.
template <typename T>
bool is_none(const Variant& value)
{
    const T* const given = value.get_if<T>();
    return given != nullptr && *given == T{};
}

/// Sets one attribute; false if it cannot be set.
bool set(NodeAttributeValues& to, AttributeId id, const Variant& value)
{
    switch (id) {
    case AttributeId::DisplayName:
        return take(value, to.display_name);
    case AttributeId::Description:
        return take(value, to.description);
    case AttributeId::InverseName:
        return take(value, to.inverse_name);
    case AttributeId::IsAbstract:
        return take(value, to.is_abstract);
    case AttributeId::Symmetric:
        return take(value, to.symmetric);
    case AttributeId::ContainsNoLoops:
        return take(value, to.contains_no_loops);
    case AttributeId::EventNotifier:
        return take_bits(value, to.event_notifier);
    case AttributeId::Value:
        to.value = value;
        return true;
    case AttributeId::DataType:
        return take(value, to.data_type);
    case AttributeId::ValueRank:
        return take(value, to.value_rank);
    case AttributeId::ArrayDimensions:
        return take_dimensions(value, to.array_dimensions);
    case AttributeId::AccessLevel:
        return take_bits(value, to.access_level);
    case AttributeId::UserAccessLevel:
        return take(value, to.user_access_level);
    case AttributeId::MinimumSamplingInterval:
        return take(value, to.minimum_sampling_interval);
    case AttributeId::Executable:
        return take(value, to.executable);
    case AttributeId::UserExecutable:
        return value.get_if<bool>() != nullptr; // the AccessControl decides it
    case AttributeId::WriteMask:
    case AttributeId::UserWriteMask:
        return is_none<std::uint32_t>(value);
    case AttributeId::Historizing:
        return is_none<bool>(value);
    case AttributeId::DataTypeDefinition: {
        const auto* const given = value.get_if<ExtensionObject>();
        to.definition = given == nullptr ? ExtensionObject{} : *given;
        return given != nullptr;
    }
    default:
        return false;
    }
}

/// Collects the attributes in the structure's mask.
class Collector {
public:
    Collector(std::uint32_t specified, NodeAttributeValues& to) : specified_{specified}, to_{&to} {}

    template <typename T>
    Collector& take(Mask bit, AttributeId id, const T& value)
    {
        if ((specified_ & static_cast<std::uint32_t>(bit)) != 0) {
            is_sound_ = set(*to_, id, Variant{value}) && is_sound_;
        }
        return *this;
    }
    /// The first fields of all structures.
    template <typename Attributes>
    Collector& take_common(const Attributes& from)
    {
        return take(Mask::DisplayName, AttributeId::DisplayName, from.display_name)
            .take(Mask::Description, AttributeId::Description, from.description)
            .take(Mask::WriteMask, AttributeId::WriteMask, from.write_mask)
            .take(Mask::UserWriteMask, AttributeId::UserWriteMask, from.user_write_mask);
    }
    /// The common attributes of Variables and VariableTypes.
    template <typename Attributes>
    Collector& take_value(const Attributes& from)
    {
        return take(Mask::Value, AttributeId::Value, from.value)
            .take(Mask::DataType, AttributeId::DataType, from.data_type)
            .take(Mask::ValueRank, AttributeId::ValueRank, from.value_rank)
            .take(Mask::ArrayDimensions, AttributeId::ArrayDimensions, from.array_dimensions);
    }
    [[nodiscard]] bool is_sound() const { return is_sound_; }

private:
    std::uint32_t specified_;
    NodeAttributeValues* to_;
    bool is_sound_{true};
};

void collect(const ObjectAttributes& from, Collector& to)
{
    to.take(Mask::EventNotifier, AttributeId::EventNotifier, from.event_notifier);
}

void collect(const VariableAttributes& from, Collector& to)
{
    to.take_value(from)
        .take(Mask::AccessLevel, AttributeId::AccessLevel, from.access_level)
        .take(Mask::UserAccessLevel, AttributeId::UserAccessLevel, from.user_access_level)
        .take(Mask::MinimumSamplingInterval, AttributeId::MinimumSamplingInterval,
              from.minimum_sampling_interval)
        .take(Mask::Historizing, AttributeId::Historizing, from.historizing);
}

void collect(const MethodAttributes& from, Collector& to)
{
    to.take(Mask::Executable, AttributeId::Executable, from.executable)
        .take(Mask::UserExecutable, AttributeId::UserExecutable, from.user_executable);
}

void collect(const ObjectTypeAttributes& from, Collector& to)
{
    to.take(Mask::IsAbstract, AttributeId::IsAbstract, from.is_abstract);
}

void collect(const VariableTypeAttributes& from, Collector& to)
{
    to.take_value(from).take(Mask::IsAbstract, AttributeId::IsAbstract, from.is_abstract);
}

void collect(const ReferenceTypeAttributes& from, Collector& to)
{
    to.take(Mask::IsAbstract, AttributeId::IsAbstract, from.is_abstract)
        .take(Mask::Symmetric, AttributeId::Symmetric, from.symmetric)
        .take(Mask::InverseName, AttributeId::InverseName, from.inverse_name);
}

void collect(const DataTypeAttributes& from, Collector& to)
{
    to.take(Mask::IsAbstract, AttributeId::IsAbstract, from.is_abstract);
}

void collect(const ViewAttributes& from, Collector& to)
{
    to.take(Mask::ContainsNoLoops, AttributeId::ContainsNoLoops, from.contains_no_loops)
        .take(Mask::EventNotifier, AttributeId::EventNotifier, from.event_notifier);
}

template <typename Attributes>
bool read(const ExtensionObject& object, NodeAttributeValues& to)
{
    const auto* const from = object.get_if<Attributes>();
    if (from == nullptr) {
        return false;
    }
    Collector collector{from->specified_attributes, to};
    collector.take_common(*from);
    collect(*from, collector);
    return collector.is_sound();
}

bool read_by_class(const ExtensionObject& object, NodeClass node_class, NodeAttributeValues& to)
{
    switch (node_class) {
    case NodeClass::Object:
        return read<ObjectAttributes>(object, to);
    case NodeClass::Variable:
        return read<VariableAttributes>(object, to);
    case NodeClass::Method:
        return read<MethodAttributes>(object, to);
    case NodeClass::ObjectType:
        return read<ObjectTypeAttributes>(object, to);
    case NodeClass::VariableType:
        return read<VariableTypeAttributes>(object, to);
    case NodeClass::ReferenceType:
        return read<ReferenceTypeAttributes>(object, to);
    case NodeClass::DataType:
        return read<DataTypeAttributes>(object, to);
    case NodeClass::View:
        return read<ViewAttributes>(object, to);
    default:
        return false;
    }
}

/// Attributes by their ids, none twice and none of the common ones (Part 4, 7.24.10).
bool read_generic(const GenericAttributes& from, NodeClass node_class, NodeAttributeValues& to)
{
    Collector collector{from.specified_attributes, to};
    std::uint32_t seen = 0;
    for (const GenericAttributeValue& each : from.attribute_values) {
        const AttributeId id{each.attribute_id};
        if (each.attribute_id <= static_cast<std::uint32_t>(AttributeId::UserWriteMask) ||
            each.attribute_id > 31 || (seen & 1U << each.attribute_id) != 0 ||
            !model::AddressSpace::has_attribute(node_class, id) || !set(to, id, each.value)) {
            return false;
        }
        seen |= 1U << each.attribute_id;
    }
    return collector.take_common(from).is_sound();
}

} // namespace

Result<NodeAttributeValues> read_attributes(const ExtensionObject& attributes, NodeClass node_class)
{
    NodeAttributeValues values;
    if (attributes.is_null()) {
        return values;
    }
    const auto* const generic = attributes.get_if<GenericAttributes>();
    const bool is_read = generic != nullptr ? read_generic(*generic, node_class, values)
                                            : read_by_class(attributes, node_class, values);
    return is_read ? Result<NodeAttributeValues>{std::move(values)}
                   : fail(status::Bad_NodeAttributesInvalid);
}

} // namespace busbar::server::detail
