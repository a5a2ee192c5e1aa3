#include "value_type.hpp"

namespace busbar::tool {

namespace {

bool is_built_in(const NodeId& data_type)
{
    return data_type.is_numeric() && data_type.namespace_index() == 0 && data_type.numeric() >= 1 &&
           data_type.numeric() <= static_cast<std::uint32_t>(BuiltInType::Variant);
}

} // namespace

TypeOfValue value_type(Connection& connection, const NodeId& data_type, std::int32_t value_rank)
{
    return value_type(is_built_in(data_type) ? nullptr
                                             : connection.types_of(std::vector<NodeId>{data_type}),
                      data_type, value_rank);
}

TypeOfValue value_type(Types types, const NodeId& data_type, std::int32_t value_rank)
{
    if (is_built_in(data_type)) {
        return {static_cast<BuiltInType>(data_type.numeric()), value_rank, nullptr, nullptr};
    }
    const binary::DynamicType* const type = types->find(data_type);
    const BuiltInType built_in = type == nullptr ? BuiltInType::Variant : type->built_in;
    return {built_in, value_rank, type, std::move(types)};
}

TypeOfValue value_type(const std::string& name, std::int32_t value_rank)
{
    for (int number = 1; number <= static_cast<int>(BuiltInType::Variant); ++number) {
        const auto type = static_cast<BuiltInType>(number);
        if (busbar::name(type) == name) {
            return {type, value_rank, nullptr, nullptr};
        }
    }
    throw Failure{Exit::Usage, name + ": not a built-in type",
                  "types are Boolean, Int32, Double, String, DateTime, ..."};
}

Variant parse_value(const std::string& text, const TypeOfValue& type, const std::string& what,
                    const Variant* base)
{
    auto value = client::parse_value(
        text, {type.built_in, type.value_rank, type.type, type.types.get(), base});
    if (!value) {
        throw Failure{Exit::Usage, what + ": " + value.error().message};
    }
    return *std::move(value);
}

} // namespace busbar::tool
