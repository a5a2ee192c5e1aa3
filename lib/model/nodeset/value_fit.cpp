#include "value_fit.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "built_in_visit.hpp"

namespace busbar::nodeset {

namespace {

template <typename T>
constexpr bool is_number = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;

/// Returns the same number as another type, nothing if that has no such number.
template <typename To, typename From>
std::optional<To> same_number(From from)
{
    if constexpr (std::is_integral_v<To> && std::is_integral_v<From>) {
        return std::in_range<To>(from) ? std::optional{static_cast<To>(from)} : std::nullopt;
    } else if constexpr (std::is_integral_v<To>) {
        // The first number past the type's last one is a power of two, which From has.
        const auto end = std::ldexp(From{1}, std::numeric_limits<To>::digits);
        const bool fits = std::trunc(from) == from && from < end &&
                          from >= static_cast<From>(std::numeric_limits<To>::min());
        return fits ? std::optional{static_cast<To>(from)} : std::nullopt;
    } else if constexpr (std::is_integral_v<From>) {
        const To to = static_cast<To>(from);
        // Back in the wider type: the last integers round up to one that From does not have.
        const bool is_same = to < std::ldexp(To{1}, std::numeric_limits<From>::digits) &&
                             static_cast<From>(to) == from;
        return is_same ? std::optional{to} : std::nullopt;
    } else {
        // A Float is written with fewer digits than a Double has: the nearest one is meant.
        const bool fits = sizeof(To) >= sizeof(From) || !std::isfinite(from) ||
                          std::abs(from) <= static_cast<From>(std::numeric_limits<To>::max());
        return fits ? std::optional{static_cast<To>(from)} : std::nullopt;
    }
}

template <typename To, typename From>
std::optional<To> same_value(const From& from)
{
    if constexpr (is_number<To> && is_number<From>) {
        return same_number<To>(from);
    } else if constexpr (std::is_same_v<To, busbar::LocalizedText> &&
                         std::is_same_v<From, String>) {
        return busbar::LocalizedText{from};
    } else if constexpr (std::is_same_v<To, String> &&
                         std::is_same_v<From, busbar::LocalizedText>) {
        return from.text;
    } else if constexpr (std::is_same_v<To, From>) {
        return from;
    } else {
        return std::nullopt;
    }
}

template <typename To, typename From>
Variant all_as(const Variant& value)
{
    if (const From* const scalar = value.get_if<From>()) {
        auto same = same_value<To>(*scalar);
        if (!same) {
            return {};
        }
        return Variant{*std::move(same)};
    }
    const Array<From>* const from = value.array_if<From>();
    if (from == nullptr) {
        return {};
    }
    Array<To> to;
    to.clear(); // not null
    to.reserve(from->size());
    for (const From& each : *from) {
        auto same = same_value<To>(each);
        if (!same) {
            return {};
        }
        to.push_back(*std::move(same));
    }
    const auto dimensions = value.dimensions();
    return dimensions.empty() ? Variant{std::move(to)}
                              : Variant::matrix(std::move(to), Array<std::uint32_t>{dimensions});
}

Variant with_type(const Variant& value, BuiltInType type)
{
    return visit_built_in(type, [&]<typename To>(std::type_identity<To>) {
        return visit_built_in(value.type(), [&]<typename From>(std::type_identity<From>) {
            if constexpr (std::is_same_v<To, Variant> || std::is_same_v<From, Variant>) {
                return Variant{};
            } else {
                return all_as<To, From>(value);
            }
        });
    });
}

/// Makes a scalar a list of one where a list is expected, and the other way round.
Variant with_rank(const Variant& value, std::int32_t value_rank)
{
    return visit_built_in(value.type(), [&]<typename T>(std::type_identity<T>) {
        if constexpr (!std::is_same_v<T, Variant>) {
            if (const T* const scalar = value.get_if<T>(); scalar != nullptr && value_rank == 1) {
                Array<T> one;
                one.push_back(*scalar);
                return Variant{std::move(one)};
            }
            const Array<T>* const list = value.array_if<T>();
            if (list != nullptr && list->size() == 1 && value_rank == -1) {
                return Variant{*list->begin()};
            }
        }
        return value;
    });
}

/// Returns true if values of `type` are those of its supertype `above`.
bool adds_nothing(const DataTypeTable& types, const DataType& type, const DataType& above)
{
    constexpr unsigned max_levels = 100;
    const DataType* at = &type;
    for (unsigned level = 0; level < max_levels && at != nullptr && at != &above; ++level) {
        at = types.supertype(at->id);
    }
    return at == &above && !type.is_abstract &&
           (types.kind(type.id) == Kind::OptionSetStructure ||
            types.fields(type.id).size() == types.fields(above.id).size());
}

/// Gives structures the encoding of `type` if they are of a supertype without fewer fields.
Variant with_structure(const DataTypeTable& types, const Variant& value, const DataType& type)
{
    const auto subtype = [&](const ExtensionObject& object) {
        const DataType* const above = types.find_encoded(object.encoding_id());
        if (above == nullptr || object.body() != ExtensionObject::Body::Binary ||
            !adds_nothing(types, type, *above)) {
            return object;
        }
        return ExtensionObject::from_binary(
            type.binary_encoding.is_null() ? type.id : type.binary_encoding, object.binary());
    };
    if (const auto* const object = value.get_if<ExtensionObject>()) {
        return Variant{subtype(*object)};
    }
    const auto* const objects = value.array_if<ExtensionObject>();
    if (objects == nullptr || value.is_matrix()) {
        return value;
    }
    Array<ExtensionObject> all;
    all.clear(); // not null
    for (const ExtensionObject& object : *objects) {
        all.push_back(subtype(object));
    }
    return Variant{std::move(all)};
}

} // namespace

Variant with_dimensions(const Variant& value, const model::VariableAttributes& attributes)
{
    const auto dimensions = attributes.array_dimensions;
    if (!value.is_array() || value.is_matrix() || dimensions.size() < 2) {
        return value;
    }
    std::uint64_t count = 1;
    for (const std::uint32_t each : dimensions) {
        count = std::min<std::uint64_t>(count * each, UINT32_MAX);
    }
    if (count == 0 || count != value.array_size()) {
        return value;
    }
    return visit_built_in(value.type(), [&]<typename T>(std::type_identity<T>) {
        const Array<T>* const list = value.array_if<T>();
        return list == nullptr ? value : Variant::matrix(*list, Array<std::uint32_t>{dimensions});
    });
}

Variant converted(const model::SpaceReader& space, const DataTypeTable& types, const Variant& value,
                  const model::VariableAttributes& attributes)
{
    const auto fits = [&](const Variant& form) {
        return !form.is_null() &&
               space
                   .check_value(form, attributes.data_type, attributes.value_rank,
                                attributes.array_dimensions)
                   .is_good();
    };
    Variant result = value;
    const std::uint32_t possible =
        space.built_in_types_of(attributes.data_type) & ~std::uint32_t{1};
    if (std::has_single_bit(possible)) {
        const BuiltInType type{static_cast<std::uint8_t>(std::countr_zero(possible))};
        if (type != value.type()) {
            result = with_type(value, type);
        }
    }
    if (const DataType* const type = types.find(space.node_id(attributes.data_type))) {
        result = with_structure(types, result, *type);
    }
    result = with_dimensions(with_rank(result, attributes.value_rank), attributes);
    return fits(result) ? result : Variant{};
}

} // namespace busbar::nodeset
