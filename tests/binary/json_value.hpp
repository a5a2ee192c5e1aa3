#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <busbar/core/types.hpp>
#include <busbar/types/fields.hpp>

/// Values of OPC UA from and to the JSON notation of tests/vectors/README.md.
namespace busbar::test {

using Json = nlohmann::json;

inline std::vector<std::byte> from_hex(const std::string& text)
{
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(std::stoul(text.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

inline std::string to_hex(std::span<const std::byte> bytes)
{
    constexpr const char* digits = "0123456789abcdef";
    std::string text;
    for (const std::byte b : bytes) {
        text += digits[std::to_integer<unsigned>(b) >> 4U];
        text += digits[std::to_integer<unsigned>(b) & 15U];
    }
    return text;
}

/// Conversions of structures by name, for ExtensionObjects; defined with the list of types.
ExtensionObject extension_from_json(const Json& json);
Json extension_to_json(const ExtensionObject& object);

template <typename T>
concept Scalar = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <Scalar T>
void from_json_value(const Json& json, T& value)
{
    if constexpr (std::is_floating_point_v<T>) {
        const std::string text = json.is_string() ? json.get<std::string>() : "";
        value = text.empty()          ? static_cast<T>(json.get<double>())
                : text == "NaN"       ? std::numeric_limits<T>::quiet_NaN()
                : text == "Infinity"  ? std::numeric_limits<T>::infinity()
                : text == "-Infinity" ? -std::numeric_limits<T>::infinity()
                                      : T{-0.0F};
    } else if constexpr (std::is_enum_v<T>) {
        value = static_cast<T>(json.get<std::int64_t>());
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
        value = std::stoull(json.get<std::string>());
    } else if constexpr (std::is_same_v<T, std::int64_t>) {
        value = std::stoll(json.get<std::string>());
    } else {
        value = json.get<T>();
    }
}

template <Scalar T>
Json to_json_value(const T& value)
{
    if constexpr (std::is_floating_point_v<T>) {
        if (std::isnan(value)) {
            return "NaN";
        }
        if (std::isinf(value)) {
            return value > 0 ? "Infinity" : "-Infinity";
        }
        return value == 0 && std::signbit(value) ? Json("-0") : Json(static_cast<double>(value));
    } else if constexpr (std::is_enum_v<T>) {
        return static_cast<std::underlying_type_t<T>>(value);
    } else if constexpr (sizeof(T) == 8) {
        return std::to_string(value);
    } else {
        return value;
    }
}

void from_json_value(const Json& json, String& value);
void from_json_value(const Json& json, XmlElement& value);
void from_json_value(const Json& json, ByteString& value);
void from_json_value(const Json& json, DateTime& value);
void from_json_value(const Json& json, Guid& value);
void from_json_value(const Json& json, NodeId& value);
void from_json_value(const Json& json, ExpandedNodeId& value);
void from_json_value(const Json& json, StatusCode& value);
void from_json_value(const Json& json, QualifiedName& value);
void from_json_value(const Json& json, LocalizedText& value);
void from_json_value(const Json& json, ExtensionObject& value);
void from_json_value(const Json& json, DataValue& value);
void from_json_value(const Json& json, Variant& value);
void from_json_value(const Json& json, DiagnosticInfo& value);

Json to_json_value(const String& value);
Json to_json_value(const ByteString& value);
Json to_json_value(DateTime value);
Json to_json_value(const Guid& value);
Json to_json_value(const NodeId& value);
Json to_json_value(const ExpandedNodeId& value);
Json to_json_value(StatusCode value);
Json to_json_value(const QualifiedName& value);
Json to_json_value(const LocalizedText& value);
Json to_json_value(const ExtensionObject& value);
Json to_json_value(const DataValue& value);
Json to_json_value(const Variant& value);
Json to_json_value(const DiagnosticInfo& value);

template <typename T>
concept Structure = requires(T& value)
{
    T::type;
    visit_fields(value, [](const char*, auto&) {});
};

template <Structure T>
void from_json_value(const Json& json, T& value);
template <Structure T>
Json to_json_value(const T& value);

template <typename T>
void from_json_value(const Json& json, Array<T>& values)
{
    values.reset();
    if (!json.is_null()) {
        values.resize(json.size());
        for (std::size_t i = 0; i < json.size(); ++i) {
            from_json_value(json[i], values[i]);
        }
    }
}
template <typename T>
Json to_json_value(const Array<T>& values)
{
    if (values.is_null()) {
        return nullptr;
    }
    Json json = Json::array();
    for (const T& value : values) {
        json.push_back(to_json_value(value));
    }
    return json;
}

template <typename T>
struct IsOptional : std::false_type {
};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {
};

template <Structure T>
void from_json_value(const Json& json, T& value)
{
    visit_fields(value, [&](const char* name, auto& field) {
        using Field = std::remove_reference_t<decltype(field)>;
        if constexpr (IsOptional<Field>::value) {
            if (json.contains(name)) {
                from_json_value(json.at(name), field.emplace());
            }
        } else {
            from_json_value(json.at(name), field);
        }
    });
}
template <Structure T>
Json to_json_value(const T& value)
{
    Json json = Json::object();
    visit_fields(value, [&](const char* name, const auto& field) {
        using Field = std::remove_cvref_t<decltype(field)>;
        if constexpr (IsOptional<Field>::value) {
            if (field) {
                json[name] = to_json_value(*field);
            }
        } else {
            json[name] = to_json_value(field);
        }
    });
    return json;
}

} // namespace busbar::test
