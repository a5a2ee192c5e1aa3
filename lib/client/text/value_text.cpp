#include <busbar/client/value_text.hpp>

#include "value_reader.hpp"

namespace busbar::client {

namespace {

using detail::Json;

Unexpected<ValueError> refuse(std::string message)
{
    return Unexpected{ValueError{std::move(message)}};
}

/// True if the text is JSON and not the value itself.
bool is_json(std::string_view text, const ValueType& type)
{
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const char c = first == std::string_view::npos ? '\0' : text[first];
    const bool may_be_object =
        type.built_in == BuiltInType::LocalizedText || type.built_in == BuiltInType::StatusCode ||
        type.built_in == BuiltInType::ExtensionObject || type.built_in == BuiltInType::Variant;
    return type.value_rank >= 0 || (c == '[' && type.value_rank != -1) ||
           (c == '{' && may_be_object);
}

/// Removes "Int16:" from the front.
std::optional<BuiltInType> take_type(std::string_view& text)
{
    const std::size_t colon = text.find(':');
    for (std::uint8_t i = 1; i <= last_built_in_type && colon != std::string_view::npos; ++i) {
        if (name(BuiltInType{i}) == text.substr(0, colon)) {
            text.remove_prefix(colon + 1);
            return BuiltInType{i};
        }
    }
    return std::nullopt;
}

/// Returns text without quotes that means the same in JSON; any other text is a String.
Json word(std::string_view text)
{
    const auto json = busbar::detail::parse_json(text);
    const bool is_word = json && json->kind != Json::Kind::String;
    return is_word ? *json : Json{Json::Kind::String, std::string{text}, {}, {}};
}

} // namespace

std::string to_text(const Variant& value, const TextOptions& options)
{
    return binary::to_text(value, options.limits, {options.types, options.type});
}

std::string to_text(const DataValue& value, const TextOptions& options)
{
    std::string text = to_text(value.value, options);
    std::string notes;
    if (value.status != status::Good) {
        const std::string_view symbol = name(value.status);
        notes = symbol.empty() ? std::to_string(value.status.value()) : std::string{symbol};
    }
    const DateTime time =
        value.source_timestamp.is_null() ? value.server_timestamp : value.source_timestamp;
    if (!time.is_null()) {
        notes += (notes.empty() ? "" : ", ") + to_string(time);
    }
    return notes.empty() ? text : text + " (" + notes + ")";
}

Expected<Variant, ValueError> parse_value(std::string_view text, const ValueType& from)
{
    ValueType type = from;
    if (type.built_in == BuiltInType::Variant) {
        if (const auto named = take_type(text)) {
            type.built_in = *named;
        }
    }
    Json json;
    if (is_json(text, type)) {
        auto parsed = busbar::detail::parse_json(text);
        if (!parsed) {
            return refuse(std::move(parsed.error()));
        }
        json = *std::move(parsed);
    } else if (type.built_in == BuiltInType::Variant) {
        json = word(text);
    } else {
        json = {Json::Kind::String, std::string{text}, {}, {}};
    }
    detail::TextValueReader reader{type.types, type.base};
    auto value = reader.read(json, type);
    if (!value) {
        return refuse(reader.error());
    }
    return *std::move(value);
}

} // namespace busbar::client
