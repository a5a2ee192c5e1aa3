#pragma once

#include <map>
#include <string>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/types/registry.hpp>

#include "json_value.hpp"

namespace busbar::test {

/// What the tests do with a type that they know by name only.
struct NamedType {
    const StructureType* structure;
    Result<std::vector<std::byte>> (*encode_json)(const Json& json);
    Result<Json> (*decode)(std::span<const std::byte> bytes);
    /// Decodes and encodes again.
    Result<std::vector<std::byte>> (*recode)(std::span<const std::byte> bytes);
    ExtensionObject (*to_extension)(const Json& json);
    Json (*from_extension)(const ExtensionObject& object);
};

/// Null if the tests have no such type.
[[nodiscard]] const NamedType* find_type(const std::string& name);

[[nodiscard]] const binary::TypeRegistry& known_types();

template <typename T>
NamedType named_type()
{
    NamedType result{};
    result.encode_json = [](const Json& json) {
        T value{};
        from_json_value(json, value);
        return binary::to_bytes(value);
    };
    result.decode = [](std::span<const std::byte> bytes) -> Result<Json> {
        const auto value = binary::from_bytes<T>(bytes, &known_types());
        return value ? Result<Json>{to_json_value(*value)} : fail(value.error());
    };
    result.recode = [](std::span<const std::byte> bytes) -> Result<std::vector<std::byte>> {
        const auto value = binary::from_bytes<T>(bytes, &known_types());
        return value ? binary::to_bytes(*value) : fail(value.error());
    };
    if constexpr (Structure<T>) {
        result.structure = &T::type;
        result.to_extension = [](const Json& json) {
            T value{};
            from_json_value(json, value);
            return ExtensionObject::from(std::move(value));
        };
        result.from_extension = [](const ExtensionObject& object) {
            return to_json_value(*object.get_if<T>());
        };
    }
    return result;
}

} // namespace busbar::test
