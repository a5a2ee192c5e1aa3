#pragma once

#include <algorithm>
#include <random>
#include <string>

#include <busbar/binary/dynamic_value.hpp>

#include "core/visit_built_in.hpp"

namespace busbar::test {

/// Fills dynamic values with content from a seed, in the one form that encoders write. Templates
/// stand before their use: Clang 14 does not find them later when a generic lambda needs them.
class RandomContent {
public:
    explicit RandomContent(std::uint32_t seed) : random_{seed} {}

private:
    [[nodiscard]] std::size_t number(std::size_t below) { return random_() % below; }
    [[nodiscard]] bool coin() { return number(2) == 0; }
    template <typename T>
    [[nodiscard]] T one()
    {
        if constexpr (std::is_same_v<T, bool>) {
            return coin();
        } else if constexpr (std::is_arithmetic_v<T>) {
            return static_cast<T>(random_());
        } else if constexpr (std::is_same_v<T, String> || std::is_same_v<T, XmlElement>) {
            return coin() ? T{} : T{String{std::string(number(9), 'x')}};
        } else if constexpr (std::is_same_v<T, ByteString>) {
            const std::string bytes(number(9), 'b');
            return coin() ? T{} : T{std::as_bytes(std::span{bytes})};
        } else if constexpr (std::is_same_v<T, NodeId>) {
            return coin() ? NodeId{one<std::uint16_t>(), one<std::uint32_t>()}
                          : NodeId{one<std::uint16_t>(), "node"};
        } else if constexpr (std::is_same_v<T, ExpandedNodeId>) {
            // A URI stands instead of the namespace index.
            return coin() ? ExpandedNodeId{one<NodeId>()}
                          : ExpandedNodeId{NodeId{0, one<std::uint32_t>()}, "urn:x", 3};
        } else if constexpr (std::is_same_v<T, StatusCode>) {
            return StatusCode{one<std::uint32_t>()};
        } else if constexpr (std::is_same_v<T, QualifiedName>) {
            return {one<std::uint16_t>(), one<String>()};
        } else if constexpr (std::is_same_v<T, LocalizedText>) {
            return coin() ? LocalizedText{} : LocalizedText{"en", "text"};
        } else if constexpr (std::is_same_v<T, Guid>) {
            return Guid{one<std::uint32_t>(), one<std::uint16_t>(), one<std::uint16_t>(), {7}};
        } else if constexpr (std::is_same_v<T, DateTime>) {
            return DateTime::from_unix_seconds(one<std::uint32_t>());
        } else if constexpr (std::is_same_v<T, ExtensionObject>) {
            return coin() ? T{} : T::from_binary(NodeId{1, 7U}, one<ByteString>());
        } else if constexpr (std::is_same_v<T, DataValue>) {
            return coin() ? T{} : T{Variant{one<std::int32_t>()}, one<StatusCode>()};
        } else {
            return T{};
        }
    }
    [[nodiscard]] Variant variant(const binary::DynamicField& field)
    {
        const Variant value = coin() ? Variant{one<std::uint16_t>()} : Variant{one<std::int64_t>()};
        const auto bit = (field.variant_types >> static_cast<unsigned>(value.type())) & 1U;
        return bit != 0 ? value : Variant{};
    }
    template <typename T>
    [[nodiscard]] static Variant matrix(Array<T> values, std::int32_t rank)
    {
        Array<std::uint32_t> dimensions;
        dimensions.resize(static_cast<std::size_t>(rank));
        std::fill(dimensions.begin(), dimensions.end(), 1U);
        dimensions[0] = static_cast<std::uint32_t>(values.size());
        return Variant::matrix(std::move(values), std::move(dimensions));
    }
    [[nodiscard]] Variant built_in(const binary::DynamicField& field)
    {
        return detail::visit_built_in(field.built_in, [&](auto tag) -> Variant {
            using T = typename decltype(tag)::type;
            if (field.is_scalar()) {
                if constexpr (std::is_same_v<T, Variant>) {
                    return variant(field);
                } else {
                    return Variant{one<T>()};
                }
            }
            Array<T> values;
            values.clear();
            for (std::size_t count = number(4); count != 0; --count) {
                if constexpr (std::is_same_v<T, Variant>) {
                    values.push_back(variant(field));
                } else {
                    values.push_back(one<T>());
                }
            }
            return field.is_matrix() ? matrix(std::move(values), field.value_rank)
                                     : Variant{std::move(values)};
        });
    }
    [[nodiscard]] bool fill(binary::DynamicValue& value, std::size_t index, unsigned depth)
    {
        const binary::DynamicField& field = value.type().fields[index];
        if (!field.is_structure) {
            return value.set(index, built_in(field)).has_value();
        }
        if (field.is_scalar()) {
            return value.set(index, structure(*field.type, depth + 1)).has_value();
        }
        binary::DynamicArray array;
        array.values.clear();
        const std::size_t count = depth > 2 || field.is_matrix() ? 0 : number(4);
        for (std::size_t i = 0; i < count; ++i) {
            array.values.push_back(structure(*field.type, depth + 1));
        }
        return value.set(index, std::move(array)).has_value();
    }

public:
    [[nodiscard]] binary::DynamicValue structure(const binary::DynamicType& type,
                                                 unsigned depth = 0)
    {
        binary::DynamicValue value{type};
        const bool is_union = type.kind == binary::DynamicType::Kind::Union;
        const std::size_t only = is_union ? number(type.fields.size() + 1) : 0;
        for (std::size_t i = 0; i < type.fields.size(); ++i) {
            const bool is_wanted = is_union ? only == i : !type.fields[i].is_optional || coin();
            if (is_wanted && !fill(value, i, depth)) {
                return value;
            }
        }
        return value;
    }

private:
    std::mt19937 random_;
};

} // namespace busbar::test
