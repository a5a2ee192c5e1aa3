#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/text.hpp>
#include <pugixml.hpp>

#include "core/number_text.hpp"

/// Helpers for small pieces of text in NodeSet2 files.
namespace busbar::nodeset {

[[nodiscard]] inline std::string_view trimmed(std::string_view text)
{
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Quotes a text for messages.
[[nodiscard]] inline std::string quoted(std::string_view text)
{
    return '"' + printable(text, 80) + '"';
}

/// Returns text in UTF-16 (with a byte order mark) as UTF-8; nothing for any other text.
[[nodiscard]] std::string from_utf16(std::string_view text);

/// Returns the element's name without its namespace prefix.
[[nodiscard]] inline std::string_view local_name(const pugi::xml_node& xml)
{
    const std::string_view name = xml.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

[[nodiscard]] inline pugi::xml_node child(const pugi::xml_node& xml, std::string_view name)
{
    for (const pugi::xml_node& entry : xml.children()) {
        if (local_name(entry) == name) {
            return entry;
        }
    }
    return {};
}

/// Returns the value of xsi:nil, whatever its prefix is.
[[nodiscard]] inline const char* nil_attribute(const pugi::xml_node& xml)
{
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        if (std::string_view{attribute.name()}.ends_with(":nil")) {
            return attribute.value();
        }
    }
    return "";
}

/// Returns false, with `value` unchanged, unless all of `text` is a number that fits; also "INF",
/// "-INF" and "NaN" if Number is floating.
template <typename Number>
[[nodiscard]] bool to_number(std::string_view text, Number& value)
{
    Number parsed{};
    const auto [end, error] =
        busbar::detail::read_number(text.data(), text.data() + text.size(), parsed);
    if (error != std::errc{} || end != text.data() + text.size()) {
        return false;
    }
    value = parsed;
    return true;
}

[[nodiscard]] inline bool to_bool(std::string_view text, bool& value)
{
    value = text == "true" || text == "1";
    return value || text == "false" || text == "0";
}

/// "2,3" and also "".
[[nodiscard]] inline bool to_numbers(std::string_view text, std::vector<std::uint32_t>& values)
{
    values.clear();
    while (!trimmed(text).empty()) {
        const std::size_t comma = text.find(',');
        if (!to_number(trimmed(text.substr(0, comma)), values.emplace_back())) {
            return false;
        }
        text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    }
    return true;
}

/// Returns a text that parse_date_time reads as the same time.
[[nodiscard]] inline std::string date_time_text(DateTime time)
{
    const std::int64_t ticks = time.clamped();
    return to_string(DateTime{ticks == INT64_MAX ? DateTime::latest : ticks});
}

struct SplitName {
    std::uint16_t namespace_index{0};
    std::string_view name;
};

/// Splits "2:Name" into its two parts; a name may have colons of its own.
[[nodiscard]] inline SplitName split_qualified_name(std::string_view text)
{
    const std::size_t colon = text.find(':');
    SplitName result{0, text};
    if (colon != std::string_view::npos &&
        to_number(text.substr(0, colon), result.namespace_index)) {
        result.name = text.substr(colon + 1);
    }
    return result;
}

} // namespace busbar::nodeset
