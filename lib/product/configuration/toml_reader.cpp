#include "toml_reader.hpp"

#include <algorithm>
#include <sstream>

namespace busbar::product {

namespace {

const toml::table& no_table()
{
    static const toml::table table;
    return table;
}

std::string shown(const toml::node& node)
{
    std::ostringstream text;
    node.visit([&](const auto& value) { text << value; });
    return text.str().substr(0, 60);
}

} // namespace

std::string TomlTable::place(const toml::node& node) const
{
    const auto line = node.source().begin.line;
    return line == 0 ? std::string{"changed online"} : file_ + ":" + std::to_string(line);
}

void TomlTable::fail(std::string_view key, const std::string& expected) const
{
    const toml::node* node = table_->get(key);
    if (node == nullptr) {
        throw ConfigError{place(*table_),
                          "found no \"" + std::string{key} + "\", expected " + expected};
    }
    throw ConfigError{place(*node) + ": " + std::string{key},
                      "found " + shown(*node) + ", expected " + expected};
}

void TomlTable::refuse(std::string_view key, const std::string& text) const
{
    const toml::node* node = table_->get(key);
    throw ConfigError{place(node == nullptr ? *table_ : *node) + ": " + std::string{key}, text};
}

void TomlTable::allow(std::span<const std::string_view> keys) const
{
    for (const auto& [key, node] : *table_) {
        if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) {
            std::string list;
            for (const std::string_view known : keys) {
                list += (list.empty() ? "" : ", ") + std::string{known};
            }
            throw ConfigError{place(node),
                              "found \"" + std::string{key.str()} + "\", expected one of: " + list};
        }
    }
}

std::string TomlTable::text(std::string_view key, std::string otherwise) const
{
    return has(key) ? text(key) : otherwise;
}

std::string TomlTable::text(std::string_view key) const
{
    const auto* value = table_->get_as<std::string>(key);
    if (value == nullptr) {
        fail(key, "a text");
    }
    return value->get();
}

bool TomlTable::flag(std::string_view key, bool otherwise) const
{
    if (!has(key)) {
        return otherwise;
    }
    const auto* value = table_->get_as<bool>(key);
    if (value == nullptr) {
        fail(key, "true or false");
    }
    return value->get();
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t otherwise, std::int64_t least,
                                std::int64_t most) const
{
    if (!has(key)) {
        return otherwise;
    }
    const auto* value = table_->get_as<std::int64_t>(key);
    if (value == nullptr || value->get() < least || value->get() > most) {
        fail(key, "a number from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return value->get();
}

double TomlTable::number(std::string_view key, double otherwise) const
{
    if (!has(key)) {
        return otherwise;
    }
    const auto value = table_->get(key)->value<double>();
    if (!value) {
        fail(key, "a number");
    }
    return *value;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const
{
    std::vector<std::string> result;
    if (!has(key)) {
        return result;
    }
    const toml::array* array = table_->get_as<toml::array>(key);
    if (array == nullptr) {
        fail(key, "a list of texts");
    }
    for (const toml::node& element : *array) {
        const auto value = element.value_exact<std::string>();
        if (!value) {
            fail(key, "a list of texts");
        }
        result.push_back(*value);
    }
    return result;
}

std::vector<std::int64_t> TomlTable::integers(std::string_view key, std::int64_t least,
                                              std::int64_t most) const
{
    std::vector<std::int64_t> result;
    if (!has(key)) {
        return result;
    }
    const std::string expected =
        "a list of numbers from " + std::to_string(least) + " to " + std::to_string(most);
    const toml::array* array = table_->get_as<toml::array>(key);
    if (array == nullptr) {
        fail(key, expected);
    }
    for (const toml::node& element : *array) {
        const auto value = element.value_exact<std::int64_t>();
        if (!value || *value < least || *value > most) {
            fail(key, expected);
        }
        result.push_back(*value);
    }
    return result;
}

TomlTable TomlTable::table(std::string_view key) const
{
    const toml::table* table = table_->get_as<toml::table>(key);
    if (table == nullptr && has(key)) {
        fail(key, "a table");
    }
    return {table == nullptr ? no_table() : *table, file_, *sources_};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const
{
    std::vector<TomlTable> result;
    if (!has(key)) {
        return result;
    }
    const toml::array* array = table_->get_as<toml::array>(key);
    if (array == nullptr || !array->is_homogeneous<toml::table>()) {
        fail(key, "tables written as [[" + std::string{key} + "]]");
    }
    for (const toml::node& element : *array) {
        result.emplace_back(*element.as_table(), file_, *sources_);
    }
    return result;
}

} // namespace busbar::product
