#include "json_value.hpp"

#include <algorithm>
#include <array>

namespace busbar::test {

namespace {

String text_of(const Json& json)
{
    return json.is_null() ? String{} : String{json.get<std::string>()};
}

/// Calls f.template operator()<T>() with the C++ type of a built-in type.
template <typename F>
auto with_type(BuiltInType type, F&& f)
{
    switch (type) {
    case BuiltInType::Boolean:
        return f.template operator()<bool>();
    case BuiltInType::SByte:
        return f.template operator()<std::int8_t>();
    case BuiltInType::Byte:
        return f.template operator()<std::uint8_t>();
    case BuiltInType::Int16:
        return f.template operator()<std::int16_t>();
    case BuiltInType::UInt16:
        return f.template operator()<std::uint16_t>();
    case BuiltInType::Int32:
        return f.template operator()<std::int32_t>();
    case BuiltInType::UInt32:
        return f.template operator()<std::uint32_t>();
    case BuiltInType::Int64:
        return f.template operator()<std::int64_t>();
    case BuiltInType::UInt64:
        return f.template operator()<std::uint64_t>();
    case BuiltInType::Float:
        return f.template operator()<float>();
    case BuiltInType::Double:
        return f.template operator()<double>();
    case BuiltInType::String:
        return f.template operator()<String>();
    case BuiltInType::DateTime:
        return f.template operator()<DateTime>();
    case BuiltInType::Guid:
        return f.template operator()<Guid>();
    case BuiltInType::ByteString:
        return f.template operator()<ByteString>();
    case BuiltInType::XmlElement:
        return f.template operator()<XmlElement>();
    case BuiltInType::NodeId:
        return f.template operator()<NodeId>();
    case BuiltInType::ExpandedNodeId:
        return f.template operator()<ExpandedNodeId>();
    case BuiltInType::StatusCode:
        return f.template operator()<StatusCode>();
    case BuiltInType::QualifiedName:
        return f.template operator()<QualifiedName>();
    case BuiltInType::LocalizedText:
        return f.template operator()<LocalizedText>();
    case BuiltInType::ExtensionObject:
        return f.template operator()<ExtensionObject>();
    case BuiltInType::DataValue:
        return f.template operator()<DataValue>();
    case BuiltInType::DiagnosticInfo:
        return f.template operator()<DiagnosticInfo>();
    default:
        return f.template operator()<Variant>();
    }
}

BuiltInType type_named(const std::string& text)
{
    for (std::uint8_t id = 0; id <= last_built_in_type; ++id) {
        if (name(static_cast<BuiltInType>(id)) == text) {
            return static_cast<BuiltInType>(id);
        }
    }
    throw std::runtime_error("no built-in type " + text);
}

template <typename T>
Variant variant_from(const Json& json)
{
    if (json.contains("array")) {
        Array<T> values;
        from_json_value(json["array"], values);
        if (json.contains("dims")) {
            Array<std::uint32_t> dimensions;
            from_json_value(json["dims"], dimensions);
            return Variant::matrix(std::move(values), std::move(dimensions));
        }
        return Variant{std::move(values)};
    }
    if constexpr (std::is_same_v<T, Variant>) {
        throw std::runtime_error("a Variant is no scalar of a Variant");
    } else {
        T value{};
        from_json_value(json["value"], value);
        return Variant{std::move(value)};
    }
}

template <typename T>
void add_value(const Variant& value, Json& json)
{
    if (value.is_array()) {
        json["array"] = to_json_value(*value.array_if<T>());
    } else {
        json["value"] = to_json_value(*value.get_if<T>());
    }
    if (value.is_matrix()) {
        json["dims"] =
            std::vector<std::uint32_t>(value.dimensions().begin(), value.dimensions().end());
    }
}

} // namespace

void from_json_value(const Json& json, String& value)
{
    value = text_of(json);
}
void from_json_value(const Json& json, XmlElement& value)
{
    value = XmlElement{text_of(json)};
}
void from_json_value(const Json& json, ByteString& value)
{
    value = json.is_null()
                ? ByteString{}
                : ByteString{std::span<const std::byte>{from_hex(json.get<std::string>())}};
}
void from_json_value(const Json& json, DateTime& value)
{
    value.ticks = std::stoll(json.get<std::string>());
}
void from_json_value(const Json& json, Guid& value)
{
    value = Guid::parse(json.get<std::string>()).value();
}
void from_json_value(const Json& json, NodeId& value)
{
    const auto index = json.at("ns").get<std::uint16_t>();
    if (json.contains("i")) {
        value = NodeId{index, json["i"].get<std::uint32_t>()};
    } else if (json.contains("s")) {
        value = NodeId{index, text_of(json["s"])};
    } else if (json.contains("g")) {
        value = NodeId{index, Guid::parse(json["g"].get<std::string>()).value()};
    } else {
        ByteString opaque;
        from_json_value(json.at("b"), opaque);
        value = NodeId{index, std::move(opaque)};
    }
}
void from_json_value(const Json& json, ExpandedNodeId& value)
{
    from_json_value(json, value.node_id);
    value.namespace_uri = json.contains("nsu") ? text_of(json["nsu"]) : String{};
    value.server_index = json.value("svr", 0U);
}
void from_json_value(const Json& json, StatusCode& value)
{
    value = StatusCode{json.get<std::uint32_t>()};
}
void from_json_value(const Json& json, QualifiedName& value)
{
    value = QualifiedName{json.at("ns").get<std::uint16_t>(), text_of(json.at("name"))};
}
void from_json_value(const Json& json, LocalizedText& value)
{
    value = LocalizedText{text_of(json.at("locale")), text_of(json.at("text"))};
}
void from_json_value(const Json& json, ExtensionObject& value)
{
    if (json.is_null()) {
        value = ExtensionObject{};
        return;
    }
    if (json.contains("type")) {
        value = extension_from_json(json);
        return;
    }
    NodeId id;
    from_json_value(json.at("typeId"), id);
    const auto body = json.at("body").get<std::string>();
    if (body == "none") {
        value = ExtensionObject::from_id(id);
    } else if (body == "xml") {
        value = ExtensionObject::from_xml(id, XmlElement{text_of(json.at("xml"))});
    } else {
        ByteString bytes;
        from_json_value(json.at("hex"), bytes);
        value = ExtensionObject::from_binary(id, std::move(bytes));
    }
}
void from_json_value(const Json& json, DataValue& value)
{
    value = DataValue{};
    if (json.contains("value")) {
        from_json_value(json["value"], value.value);
    }
    value.status = StatusCode{json.value("status", 0U)};
    value.source_picoseconds = json.value("sourcePicoseconds", std::uint16_t{0});
    value.server_picoseconds = json.value("serverPicoseconds", std::uint16_t{0});
    from_json_value(json.value("sourceTimestamp", "0"), value.source_timestamp);
    from_json_value(json.value("serverTimestamp", "0"), value.server_timestamp);
}
void from_json_value(const Json& json, Variant& value)
{
    const BuiltInType type = type_named(json.at("type").get<std::string>());
    value = type == BuiltInType::Null
                ? Variant{}
                : with_type(type, [&]<typename T>() { return variant_from<T>(json); });
}
void from_json_value(const Json& json, DiagnosticInfo& value)
{
    const auto number = [&](const char* key, std::optional<std::int32_t>& to) {
        if (json.contains(key)) {
            to = json[key].get<std::int32_t>();
        }
    };
    value = DiagnosticInfo{};
    number("symbolicId", value.symbolic_id);
    number("namespaceUri", value.namespace_uri);
    number("locale", value.locale);
    number("localizedText", value.localized_text);
    if (json.contains("additionalInfo")) {
        value.additional_info = text_of(json["additionalInfo"]);
    }
    if (json.contains("innerStatusCode")) {
        value.inner_status_code = StatusCode{json["innerStatusCode"].get<std::uint32_t>()};
    }
    if (json.contains("innerDiagnosticInfo")) {
        value.inner_diagnostic_info = std::make_unique<DiagnosticInfo>();
        from_json_value(json["innerDiagnosticInfo"], *value.inner_diagnostic_info);
    }
}

Json to_json_value(const String& value)
{
    return value.is_null() ? Json(nullptr) : Json(value.str());
}
Json to_json_value(const ByteString& value)
{
    return value.is_null() ? Json(nullptr) : Json(to_hex(value.span()));
}
Json to_json_value(DateTime value)
{
    return std::to_string(value.ticks);
}
Json to_json_value(const Guid& value)
{
    std::string text = to_string(value);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}
Json to_json_value(const NodeId& value)
{
    Json json{{"ns", value.namespace_index()}};
    switch (value.id_type()) {
    case IdType::Numeric:
        json["i"] = value.numeric();
        break;
    case IdType::String:
        json["s"] = to_json_value(value.string());
        break;
    case IdType::Guid:
        json["g"] = to_json_value(value.guid());
        break;
    case IdType::Opaque:
        json["b"] = to_json_value(value.opaque());
        break;
    }
    return json;
}
Json to_json_value(const ExpandedNodeId& value)
{
    Json json = to_json_value(value.node_id);
    if (!value.namespace_uri.is_null()) {
        json["nsu"] = value.namespace_uri.str();
    }
    if (value.server_index != 0) {
        json["svr"] = value.server_index;
    }
    return json;
}
Json to_json_value(StatusCode value)
{
    return value.value();
}
Json to_json_value(const QualifiedName& value)
{
    return {{"ns", value.namespace_index}, {"name", to_json_value(value.name)}};
}
Json to_json_value(const LocalizedText& value)
{
    return {{"locale", to_json_value(value.locale)}, {"text", to_json_value(value.text)}};
}
Json to_json_value(const ExtensionObject& value)
{
    if (value.is_null()) {
        return nullptr;
    }
    if (value.body() == ExtensionObject::Body::Object) {
        return extension_to_json(value);
    }
    Json json{{"typeId", to_json_value(value.encoding_id())}};
    switch (value.body()) {
    case ExtensionObject::Body::Binary:
        json["body"] = "binary";
        json["hex"] = to_json_value(value.binary());
        break;
    case ExtensionObject::Body::Xml:
        json["body"] = "xml";
        json["xml"] = to_json_value(value.xml());
        break;
    default:
        json["body"] = "none";
        break;
    }
    return json;
}
Json to_json_value(const DataValue& value)
{
    Json json = Json::object();
    const auto add = [&](bool condition, const char* key, const Json& part) {
        if (condition) {
            json[key] = part;
        }
    };
    add(!value.value.is_null(), "value", to_json_value(value.value));
    add(value.status != StatusCode{}, "status", value.status.value());
    add(!value.source_timestamp.is_null(), "sourceTimestamp",
        to_json_value(value.source_timestamp));
    add(!value.server_timestamp.is_null(), "serverTimestamp",
        to_json_value(value.server_timestamp));
    add(value.source_picoseconds != 0, "sourcePicoseconds", value.source_picoseconds);
    add(value.server_picoseconds != 0, "serverPicoseconds", value.server_picoseconds);
    return json;
}
Json to_json_value(const Variant& value)
{
    Json json{{"type", std::string{name(value.type())}}};
    if (!value.is_null()) {
        with_type(value.type(), [&]<typename T>() {
            if constexpr (std::is_same_v<T, Variant>) {
                json["array"] = to_json_value(*value.array_if<Variant>());
                if (value.is_matrix()) {
                    json["dims"] = std::vector<std::uint32_t>(value.dimensions().begin(),
                                                              value.dimensions().end());
                }
            } else {
                add_value<T>(value, json);
            }
        });
    }
    return json;
}
Json to_json_value(const DiagnosticInfo& value)
{
    Json json = Json::object();
    const auto number = [&](const char* key, const std::optional<std::int32_t>& from) {
        if (from) {
            json[key] = *from;
        }
    };
    number("symbolicId", value.symbolic_id);
    number("namespaceUri", value.namespace_uri);
    number("locale", value.locale);
    number("localizedText", value.localized_text);
    if (value.additional_info) {
        json["additionalInfo"] = to_json_value(*value.additional_info);
    }
    if (value.inner_status_code) {
        json["innerStatusCode"] = value.inner_status_code->value();
    }
    if (value.inner_diagnostic_info != nullptr) {
        json["innerDiagnosticInfo"] = to_json_value(*value.inner_diagnostic_info);
    }
    return json;
}

} // namespace busbar::test
