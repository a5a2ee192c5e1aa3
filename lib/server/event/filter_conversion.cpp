#include "filter_conversion.hpp"

#include <array>
#include <string_view>

#include "core/visit_built_in.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::size_t type_count = 21;

/// Part 4, 7.7.3, Conversion rules. Row: source; column: target; both Boolean to LocalizedText by
/// their ids. I: implicit, E: by Cast only, '.': none.
constexpr std::array<std::string_view, type_count> conversion_rules{
    //   Bo SB By I2 U2 I4 U4 I8 U8 Fl Do St Dt Gu BS Xm Ni Xi Sc Qn Lt
    "-IIIIIIIIIIE.........", // Boolean
    "E-EIIIIIIIIE.........", // SByte
    "EI-IIIIIIIIE.........", // Byte
    "EEE-EIIIIIIE.........", // Int16
    "EEEI-IIIIIIE......I..", // UInt16
    "EEEEE-EIIIIE......E..", // Int32
    "EEEEEI-IIIIE......E..", // UInt32
    "EEEEEEE-EIIE......E..", // Int64
    "EEEEEEEI-IIE......E..", // UInt64
    "EEEEEEEEE-IE.........", // Float
    "EEEEEEEEEE-E.........", // Double
    "IIIIIIIIIII-EI..EE.EE", // String
    "...........E-........", // DateTime
    "...........E.-E......", // Guid
    ".............E-......", // ByteString
    "...............-.....", // XmlElement
    "...........I....-I...", // NodeId
    "...........I....E-...", // ExpandedNodeId
    "....EIIII.........-..", // StatusCode
    "...........I.......-I", // QualifiedName
    "...........I........-", // LocalizedText
};

static_assert(
    [] {
        for (std::size_t i = 0; i < type_count; ++i) {
            if (conversion_rules[i].size() != type_count || conversion_rules[i][i] != '-') {
                return false;
            }
        }
        return true;
    }(),
    "a type is the same as itself only");

/// Part 4, 7.7.3, Data precedence: a value is converted to the type that comes first here.
constexpr std::array precedence{
    BuiltInType::Double,     BuiltInType::Float,         BuiltInType::Int64,
    BuiltInType::UInt64,     BuiltInType::Int32,         BuiltInType::UInt32,
    BuiltInType::StatusCode, BuiltInType::Int16,         BuiltInType::UInt16,
    BuiltInType::SByte,      BuiltInType::Byte,          BuiltInType::Boolean,
    BuiltInType::Guid,       BuiltInType::String,        BuiltInType::ExpandedNodeId,
    BuiltInType::NodeId,     BuiltInType::LocalizedText, BuiltInType::QualifiedName,
};

std::size_t place(BuiltInType type)
{
    return static_cast<std::size_t>(type) - 1;
}

template <typename T>
Variant element(const Variant& array, std::size_t index)
{
    if constexpr (std::is_same_v<T, Variant>) {
        return (*array.array_if<Variant>())[index];
    } else {
        return Variant{(*array.array_if<T>())[index]};
    }
}

Variant element(const Variant& array, std::size_t index)
{
    return busbar::detail::visit_built_in(array.type(), [&](auto tag) {
        return element<typename decltype(tag)::type>(array, index);
    });
}

/// An element that cannot be converted makes the whole array inconvertible (Part 4, 7.7.3).
template <typename T>
Variant convert_array(const Variant& array)
{
    Array<T> converted;
    converted.reserve(array.array_size());
    for (std::size_t i = 0; i < array.array_size(); ++i) {
        Variant scalar = convert_scalar(element(array, i), built_in_type_of<T>);
        T* const value = scalar.get_if<T>();
        if (value == nullptr) {
            return {};
        }
        converted.push_back(std::move(*value));
    }
    return Variant::matrix(std::move(converted), Array<std::uint32_t>{array.dimensions()});
}

Variant convert(const Variant& value, BuiltInType to)
{
    if (value.is_scalar()) {
        return convert_scalar(value, to);
    }
    return busbar::detail::visit_built_in(to, [&](auto tag) -> Variant {
        using T = typename decltype(tag)::type;
        if constexpr (std::is_same_v<T, Variant>) {
            return {};
        } else {
            return convert_array<T>(value);
        }
    });
}

} // namespace

Conversion conversion(BuiltInType from, BuiltInType to)
{
    if (from == to) {
        return from == BuiltInType::Null ? Conversion::None : Conversion::Same;
    }
    if (place(from) >= type_count || place(to) >= type_count) {
        return Conversion::None;
    }
    return Conversion{conversion_rules[place(from)][place(to)]};
}

BuiltInType common_type(BuiltInType a, BuiltInType b)
{
    if (a == b) {
        return a;
    }
    for (const BuiltInType type : precedence) {
        if (type == a || type == b) {
            return conversion(type == a ? b : a, type) == Conversion::Implicit ? type
                                                                               : BuiltInType::Null;
        }
    }
    return BuiltInType::Null;
}

Variant convert_implicitly(const Variant& value, BuiltInType to)
{
    switch (conversion(value.type(), to)) {
    case Conversion::Same:
        return value;
    case Conversion::Implicit:
        return convert(value, to);
    default:
        return {};
    }
}

Variant convert_explicitly(const Variant& value, BuiltInType to)
{
    const Conversion rule = conversion(value.type(), to);
    return rule == Conversion::Explicit ? convert(value, to) : convert_implicitly(value, to);
}

const Variant& as_scalar(const Variant& value, Variant& storage)
{
    if (!value.is_array() || value.array_size() != 1) {
        return value;
    }
    storage = element(value, 0);
    return storage;
}

} // namespace busbar::server::detail
