#include "project_fields.hpp"

#include <charconv>

#include <core/utf8.hpp>

namespace busbar::controller::detail {

namespace {

constexpr std::string_view list_separator = ", ";

} // namespace

bool is_project_text(std::string_view text)
{
    while (!text.empty()) {
        const auto first = static_cast<unsigned char>(text.front());
        const std::size_t size = busbar::detail::utf8_sequence(text);
        if (size == 0 || first < 0x20 || first == 0x7F) {
            return false;
        }
        text.remove_prefix(size);
    }
    return true;
}

std::string value_text(const std::vector<std::string>& list)
{
    std::string text;
    for (const std::string& each : list) {
        text += text.empty() ? std::string_view{} : list_separator;
        text += each;
    }
    return text;
}

std::string read_value(std::string_view text, bool& to)
{
    if (text != "yes" && text != "no") {
        return "yes or no";
    }
    to = text == "yes";
    return {};
}

std::string read_value(std::string_view text, std::uint32_t& to)
{
    std::uint32_t number = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (read.ec != std::errc{} || read.ptr != end) {
        return "a number";
    }
    to = number;
    return {};
}

std::string read_value(std::string_view text, std::vector<std::string>& to)
{
    std::vector<std::string> list;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(list_separator), text.size());
        if (end == 0 || end + list_separator.size() == text.size()) {
            return "names with \", \" between them";
        }
        list.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + list_separator.size(), text.size()));
    }
    to = std::move(list);
    return {};
}

} // namespace busbar::controller::detail
