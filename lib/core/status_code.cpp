#include <busbar/core/text.hpp>

#include <charconv>

#include <busbar/core/text_forms.hpp>

namespace busbar {

namespace {

struct Row {
    std::uint32_t value;
    std::string_view name;
};

constexpr Row rows[] = {
#include <busbar/core/status_names.inc>
};

} // namespace

std::string_view name(StatusCode code)
{
    const std::uint32_t wanted = code.code().value();
    for (const Row& row : rows) {
        if (row.value == wanted) {
            return row.name;
        }
    }
    return {};
}

std::optional<StatusCode> parse_status_code(std::string_view text)
{
    for (const Row& row : rows) {
        if (row.name == text) {
            return StatusCode{row.value};
        }
    }
    const bool is_hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    text.remove_prefix(is_hexadecimal ? 2 : 0);
    std::uint32_t value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, is_hexadecimal ? 16 : 10);
    if (error != std::errc{} || end != text.data() + text.size()) {
        return std::nullopt;
    }
    return StatusCode{value};
}

} // namespace busbar
