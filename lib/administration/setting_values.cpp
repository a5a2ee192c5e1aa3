#include "setting_values.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

#include <busbar/core/text.hpp>
#include <core/number_text.hpp>

namespace busbar::administration::detail {

namespace {

void write_one(JsonWriter& json, bool value)
{
    json.word(value ? "true" : "false");
}

void write_one(JsonWriter& json, std::int64_t value)
{
    json.word(std::to_string(value));
}

void write_one(JsonWriter& json, double value)
{
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value);
    json.word({text, static_cast<std::size_t>(end.ptr - text)});
}

void write_one(JsonWriter& json, const String& value)
{
    json.string(value.view());
}

template <typename T>
bool write_as(JsonWriter& json, const Variant& value)
{
    if (const T* const one = value.get_if<T>()) {
        write_one(json, *one);
        return true;
    }
    const Array<T>* const list = value.array_if<T>();
    if (list == nullptr) {
        return false;
    }
    json.begin_list();
    for (const T& each : *list) {
        write_one(json, each);
    }
    json.end_list();
    return true;
}

bool read_one(const Json& json, std::int64_t& value)
{
    const char* const end = json.text.data() + json.text.size();
    const auto read = std::from_chars(json.text.data(), end, value);
    return json.kind == Json::Kind::Number && read.ec == std::errc{} && read.ptr == end;
}

bool read_one(const Json& json, double& value)
{
    const char* const end = json.text.data() + json.text.size();
    const auto read = busbar::detail::read_number(json.text.data(), end, value);
    return json.kind == Json::Kind::Number && read.ec == std::errc{} && read.ptr == end &&
           std::isfinite(value);
}

bool read_one(const Json& json, bool& value)
{
    value = json.kind == Json::Kind::True;
    return value || json.kind == Json::Kind::False;
}

bool read_one(const Json& json, String& value)
{
    value = String{json.text};
    return json.kind == Json::Kind::String;
}

template <typename T>
std::optional<Variant> read_as(const Json& json, const Variant& like)
{
    T value{};
    if (!like.is_array()) {
        return read_one(json, value) ? std::optional{Variant{std::move(value)}} : std::nullopt;
    }
    if (json.kind != Json::Kind::List) {
        return std::nullopt;
    }
    Array<T> list;
    list.clear(); // not null
    for (const Json& each : json.items) {
        if (!read_one(each, value)) {
            return std::nullopt;
        }
        list.push_back(value);
    }
    return Variant{std::move(list)};
}

} // namespace

void write_value(JsonWriter& json, const Variant& value)
{
    if (!write_as<bool>(json, value) && !write_as<std::int64_t>(json, value) &&
        !write_as<double>(json, value) && !write_as<String>(json, value)) {
        json.word("null");
    }
}

std::optional<Variant> value_of(const Json& json, const Variant& like)
{
    switch (like.type()) {
    case BuiltInType::Boolean:
        return read_as<bool>(json, like);
    case BuiltInType::Int64:
        return read_as<std::int64_t>(json, like);
    case BuiltInType::Double:
        return read_as<double>(json, like);
    default:
        return read_as<String>(json, like);
    }
}

std::string shown(const Variant& value)
{
    JsonWriter json;
    write_value(json, value);
    return printable(json.take());
}

std::string kind_of(const Variant& like)
{
    const bool is_list = like.is_array();
    switch (like.type()) {
    case BuiltInType::Boolean:
        return is_list ? "a list of true and false" : "true or false";
    case BuiltInType::Int64:
        return is_list ? "a list of whole numbers" : "a whole number";
    case BuiltInType::Double:
        return is_list ? "a list of numbers" : "a number";
    default:
        return is_list ? "a list of texts" : "a text";
    }
}

} // namespace busbar::administration::detail
