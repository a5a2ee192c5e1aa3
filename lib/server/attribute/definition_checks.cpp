#include "definition_checks.hpp"

#include <algorithm>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_access.hpp>
#include <busbar/types/ids.hpp>

#include "binary/dynamic/body_walk.hpp"

namespace busbar::server::detail {

namespace {

bool may_hold_structures(const Variant& value)
{
    return value.type() == BuiltInType::ExtensionObject || value.type() == BuiltInType::Variant ||
           value.type() == BuiltInType::DataValue;
}

bool has_value(const binary::DynamicType& enumeration, std::int32_t value)
{
    const auto& values = enumeration.values;
    const auto index = static_cast<std::size_t>(value);
    if (value >= 0 && index < values.size() && values[index].value == value) {
        return true; // numbered from 0, as most are
    }
    return std::any_of(values.begin(), values.end(),
                       [&](const auto& each) { return each.value == value; });
}

} // namespace

StatusCode DataTypeChecks::check(model::NodeIndex variable, model::NodeIndex data_type,
                                 const Variant& value)
{
    StatusCode bad = check_enumeration(data_type, value);
    if (bad.is_good()) {
        bad = model::check_state(space_, variable, value);
    }
    return bad.is_bad() ? bad : check_structures(value);
}

bool DataTypeChecks::is_only_too_long(const Variant& value)
{
    return may_hold_structures(value) &&
           binary::detail::check_dynamic_of_any_length(value, data_types_.of(space_),
                                                       binary::dynamic_decode_limits(limits_))
               .is_good();
}

void DataTypeChecks::replaced(model::AddressSpace& space, model::NodeIndex variable)
{
    model::update_value_as_text(space, variable);
}

StatusCode DataTypeChecks::check_structures(const Variant& value)
{
    return may_hold_structures(value)
               ? binary::check_dynamic(value, data_types_.of(space_),
                                       binary::dynamic_decode_limits(limits_))
               : status::Good;
}

/// Returns the enumeration's own values or those of the supertype that has them; null if none are
/// known.
const binary::DynamicType* DataTypeChecks::enumeration_of(model::NodeIndex data_type)
{
    if (!space_.is_subtype_of(data_type, id::Enumeration)) {
        return nullptr;
    }
    const auto* type = data_types_.of(space_).find(space_.node_id(data_type));
    while (type != nullptr && type->values.empty()) {
        type = type->base;
    }
    return type;
}

StatusCode DataTypeChecks::check_enumeration(model::NodeIndex data_type, const Variant& value)
{
    const auto* const enumeration =
        value.type() == BuiltInType::Int32 ? enumeration_of(data_type) : nullptr;
    if (enumeration == nullptr) {
        return status::Good;
    }
    const auto is_known = [&](std::int32_t each) { return has_value(*enumeration, each); };
    const auto* const one = value.get_if<std::int32_t>();
    const auto* const all = value.array_if<std::int32_t>();
    const bool is_valid = (one == nullptr || is_known(*one)) &&
                          (all == nullptr || std::all_of(all->begin(), all->end(), is_known));
    return is_valid ? status::Good : status::Bad_OutOfRange;
}

} // namespace busbar::server::detail
