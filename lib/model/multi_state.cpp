#include "multi_state.hpp"

#include <optional>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/model/data_access.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model {

namespace {

std::optional<std::int64_t> integer_of(const Variant& value)
{
    std::optional<std::int64_t> result;
    const auto take = [&](const auto* number) {
        if (number != nullptr && std::in_range<std::int64_t>(*number)) {
            result = static_cast<std::int64_t>(*number);
        }
    };
    take(value.get_if<std::int8_t>());
    take(value.get_if<std::uint8_t>());
    take(value.get_if<std::int16_t>());
    take(value.get_if<std::uint16_t>());
    take(value.get_if<std::int32_t>());
    take(value.get_if<std::uint32_t>());
    take(value.get_if<std::int64_t>());
    take(value.get_if<std::uint64_t>());
    return result;
}

Array<EnumValueType> enum_values_of(const Variant& value)
{
    Array<EnumValueType> values;
    if (const auto* const objects = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& object : *objects) {
            if (auto each = binary::structure_of<EnumValueType>(object)) {
                values.push_back(*std::move(each));
            }
        }
    }
    return values;
}

/// The properties with the values that a Variable of a multi-state type may have.
struct States {
    NodeIndex strings{no_node};
    NodeIndex values{no_node};
};

States states_of(const SpaceReader& space, NodeIndex variable)
{
    const NodeIndex type = space.type_definition(variable);
    if (type == no_node || !space.is_subtype_of(type, id::DiscreteItemType)) {
        return {};
    }
    if (space.is_subtype_of(type, id::MultiStateDiscreteType)) {
        return {find_by_path(space, variable, "EnumStrings"), no_node};
    }
    return space.is_subtype_of(type, id::MultiStateValueDiscreteType)
               ? States{no_node, find_by_path(space, variable, "EnumValues")}
               : States{};
}

bool is_among(const Array<EnumValueType>& values, std::int64_t number)
{
    for (const EnumValueType& each : values) {
        if (each.value == number) {
            return true;
        }
    }
    return false;
}

Result<void> set_text(AddressSpace& space, NodeIndex variable, NodeIndex values, NodeIndex as_text)
{
    return as_text == no_node
               ? Result<void>{}
               : space.set_value(as_text, detail::text_of(space.value(variable),
                                                          enum_values_of(space.value(values))));
}

} // namespace

namespace detail {

LocalizedText text_of(const Variant& value, const Array<EnumValueType>& enum_values)
{
    const auto number = integer_of(value);
    for (const EnumValueType& each : enum_values) {
        if (number && each.value == *number) {
            return each.display_name;
        }
    }
    return {};
}

} // namespace detail

StatusCode check_state(const SpaceReader& space, NodeIndex variable, const Variant& value)
{
    const States states = value.is_scalar() ? states_of(space, variable) : States{};
    const std::optional<std::int64_t> number = integer_of(value);
    bool is_known = true;
    if (states.strings != no_node) {
        const Variant strings = space.value(states.strings);
        const auto* const texts = strings.array_if<LocalizedText>();
        is_known =
            texts == nullptr || (number && *number >= 0 && std::cmp_less(*number, texts->size()));
    } else if (states.values != no_node) {
        const Array<EnumValueType> values = enum_values_of(space.value(states.values));
        is_known = values.empty() || (number && is_among(values, *number));
    }
    return is_known ? status::Good : status::Bad_OutOfRange;
}

void update_value_as_text(AddressSpace& space, NodeIndex variable)
{
    const States states = states_of(space, variable);
    if (states.values != no_node) {
        static_cast<void>(
            set_text(space, variable, states.values, find_by_path(space, variable, "ValueAsText")));
    }
}

Result<void> set_multi_state_value(AddressSpace& space, NodeIndex node, Variant value)
{
    const NodeIndex values = find_by_path(space, node, "EnumValues");
    const NodeIndex as_text = find_by_path(space, node, "ValueAsText");
    if (values == no_node || as_text == no_node) {
        return fail(status::Bad_NotFound);
    }
    if (auto set = space.set_value(node, std::move(value)); !set) {
        return set;
    }
    return set_text(space, node, values, as_text);
}

} // namespace busbar::model
