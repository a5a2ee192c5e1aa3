#include "setting_keys.hpp"

#include <cstdio>
#include <optional>
#include <sstream>
#include <utility>

#include "toml.hpp"
#include "toml_reader.hpp"

namespace busbar::product {

namespace {

/// Parses an inline table: `{ name = "Speed", type = "Int16" }`.
toml::table table_of(const std::string& name, std::string_view text)
{
    auto parsed = parse_toml("value = " + std::string{text});
    if (!parsed) {
        throw ConfigError{name,
                          parsed.error().text + ", expected { key = value, ... } in each text"};
    }
    if (parsed->size() == 1 && (*parsed)["value"].is_table()) {
        return *(*parsed)["value"].as_table();
    }
    throw ConfigError{name, "found \"" + std::string{text} +
                                "\", expected { key = value, ... } in each text"};
}

template <typename T>
toml::array array_of(const Array<T>& list)
{
    toml::array array;
    for (const T& each : list) {
        if constexpr (std::is_same_v<T, String>) {
            array.push_back(each.str());
        } else {
            array.push_back(each);
        }
    }
    return array;
}

void insert(toml::table& into, std::string_view key, const std::string& name, const Variant& value)
{
    if (const auto* const flag = value.get_if<bool>()) {
        into.insert_or_assign(key, *flag);
    } else if (const auto* const number = value.get_if<std::int64_t>()) {
        into.insert_or_assign(key, *number);
    } else if (const auto* const real = value.get_if<double>()) {
        into.insert_or_assign(key, *real);
    } else if (const auto* const text = value.get_if<String>()) {
        into.insert_or_assign(key, text->str());
    } else if (const auto* const numbers = value.array_if<std::int64_t>()) {
        into.insert_or_assign(key, array_of(*numbers));
    } else if (const auto* const texts = value.array_if<String>()) {
        if (!is_table_list(name)) {
            into.insert_or_assign(key, array_of(*texts));
            return;
        }
        if (texts->empty()) {
            into.erase(key); // an empty array would be an array of values
            return;
        }
        toml::array tables;
        for (const String& each : *texts) {
            tables.push_back(table_of(name, each.view()));
        }
        into.insert_or_assign(key, std::move(tables));
        if (name == "endpoint") {
            into.erase("security"); // it sets the same in another form
        }
    }
}

template <typename T>
std::optional<Variant> list_in(const toml::array& array)
{
    Array<T> list;
    list.clear(); // not null
    for (const toml::node& each : array) {
        if constexpr (std::is_same_v<T, String>) {
            if (const toml::table* const table = each.as_table()) {
                toml::table shown{*table};
                shown.is_inline(true);
                std::ostringstream text;
                text << shown;
                list.push_back(String{text.str()});
                continue;
            }
            const auto text = each.value_exact<std::string>();
            if (!text) {
                return std::nullopt;
            }
            list.push_back(String{*text});
        } else {
            const auto number = each.value_exact<T>();
            if (!number) {
                return std::nullopt;
            }
            list.push_back(*number);
        }
    }
    return Variant{std::move(list)};
}

template <typename T>
std::string list_text(const Array<T>& list)
{
    std::string text;
    for (const T& each : list) {
        text += text.empty() ? "" : ", ";
        if constexpr (std::is_same_v<T, String>) {
            text += "\"" + each.str() + "\"";
        } else {
            text += std::to_string(each);
        }
    }
    return "[" + text + "]";
}

} // namespace

void overlay(toml::table& file, const administration::SettingValues& changes)
{
    for (const auto& [name, value] : changes) {
        toml::table* table = &file;
        std::string_view rest = name;
        for (std::size_t point = rest.find('.'); point != std::string_view::npos;
             point = rest.find('.')) {
            const std::string_view part = rest.substr(0, point);
            rest.remove_prefix(point + 1);
            if (table->get_as<toml::table>(part) == nullptr) {
                table->insert_or_assign(part, toml::table{});
            }
            table = table->get_as<toml::table>(part);
        }
        insert(*table, rest, name, value);
    }
}

Variant value_in(const toml::table& file, const administration::Setting& setting)
{
    const toml::node_view<const toml::node> node = file.at_path(setting.name);
    const Variant& like = setting.otherwise;
    if (const toml::array* const array = node.as_array(); like.is_array() && array != nullptr) {
        return (like.type() == BuiltInType::Int64 ? list_in<std::int64_t>(*array)
                                                  : list_in<String>(*array))
            .value_or(Variant{});
    }
    if (like.is_array()) {
        return {};
    }
    switch (like.type()) {
    case BuiltInType::Boolean:
        return node.is_boolean() ? Variant{*node.value_exact<bool>()} : Variant{};
    case BuiltInType::Int64:
        return node.is_integer() ? Variant{*node.value_exact<std::int64_t>()} : Variant{};
    case BuiltInType::Double:
        return node.is_number() ? Variant{*node.value<double>()} : Variant{};
    default:
        return node.is_string() ? Variant{String{*node.value_exact<std::string>()}} : Variant{};
    }
}

std::string value_text(const Variant& value)
{
    if (const auto* const flag = value.get_if<bool>()) {
        return *flag ? "true" : "false";
    }
    if (const auto* const number = value.get_if<std::int64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* const real = value.get_if<double>()) {
        char digits[32]; // the shortest form
        static_cast<void>(std::snprintf(digits, sizeof digits, "%.15g", *real));
        return digits;
    }
    if (const auto* const text = value.get_if<String>()) {
        return "\"" + text->str() + "\"";
    }
    if (const auto* const numbers = value.array_if<std::int64_t>()) {
        return list_text(*numbers);
    }
    if (const auto* const texts = value.array_if<String>()) {
        return list_text(*texts);
    }
    return "no valid configuration";
}

} // namespace busbar::product
