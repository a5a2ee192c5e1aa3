#include "data_type_root.hpp"

#include <busbar/types/ids.hpp>

namespace busbar::binary::detail {

namespace {

using Kind = DynamicType::Kind;

constexpr std::uint32_t bit(BuiltInType type)
{
    return std::uint32_t{1} << static_cast<unsigned>(type);
}

constexpr std::uint32_t signed_types = bit(BuiltInType::SByte) | bit(BuiltInType::Int16) |
                                       bit(BuiltInType::Int32) | bit(BuiltInType::Int64);
constexpr std::uint32_t unsigned_types = bit(BuiltInType::Byte) | bit(BuiltInType::UInt16) |
                                         bit(BuiltInType::UInt32) | bit(BuiltInType::UInt64);
/// A Decimal is an ExtensionObject (Part 6, 5.1.10).
constexpr std::uint32_t decimal_types = bit(BuiltInType::ExtensionObject);
constexpr std::uint32_t number_types = signed_types | unsigned_types | bit(BuiltInType::Float) |
                                       bit(BuiltInType::Double) | decimal_types;

} // namespace

std::optional<DataTypeRoot> data_type_root(const NodeId& data_type)
{
    if (!data_type.is_numeric() || data_type.namespace_index() != 0) {
        return std::nullopt;
    }
    switch (data_type.numeric()) {
    case id::Structure:
        return DataTypeRoot{Kind::Structure, BuiltInType::ExtensionObject};
    case id::Number:
        return DataTypeRoot{Kind::Simple, BuiltInType::Variant, number_types};
    case id::Integer:
        return DataTypeRoot{Kind::Simple, BuiltInType::Variant, signed_types};
    case id::UInteger:
        return DataTypeRoot{Kind::Simple, BuiltInType::Variant, unsigned_types};
    case id::Decimal:
        return DataTypeRoot{Kind::Simple, BuiltInType::Variant, decimal_types};
    case id::Enumeration:
        return DataTypeRoot{Kind::Enumeration, BuiltInType::Int32};
    case id::OptionSet:
        return DataTypeRoot{Kind::Structure, BuiltInType::ExtensionObject, UINT32_MAX, true};
    case id::Union:
        return DataTypeRoot{Kind::Union, BuiltInType::ExtensionObject};
    default:
        break;
    }
    if (data_type.numeric() == 0 || data_type.numeric() > last_built_in_type) {
        return std::nullopt;
    }
    const auto built_in = static_cast<BuiltInType>(data_type.numeric());
    return DataTypeRoot{Kind::Simple, built_in,
                        built_in == BuiltInType::Variant ? UINT32_MAX : bit(built_in)};
}

bool is_open_structure(const NodeId& data_type)
{
    return data_type.is(id::Structure) || data_type.is(id::Union) || data_type.is(id::OptionSet);
}

} // namespace busbar::binary::detail
