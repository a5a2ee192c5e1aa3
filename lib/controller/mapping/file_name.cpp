#include <algorithm>
#include <array>

#include <busbar/controller/model_set.hpp>

#include "core/ascii_case.hpp"

namespace busbar::controller {

namespace {

using busbar::detail::is_same_ignoring_case;

constexpr std::string_view prohibited_characters{"<>:\"/\\|?*\0", 10};

/// Device names that Windows reserves (SH-082679, appendix 6, note 2); COM and LPT also with
/// superscript digits.
constexpr std::array<std::string_view, 28> reserved_names{
    "CON",       "PRN",       "AUX",  "NUL",  "COM1",      "COM2",      "COM3",
    "COM4",      "COM5",      "COM6", "COM7", "COM8",      "COM9",      "COM\u00B9",
    "COM\u00B2", "COM\u00B3", "LPT1", "LPT2", "LPT3",      "LPT4",      "LPT5",
    "LPT6",      "LPT7",      "LPT8", "LPT9", "LPT\u00B9", "LPT\u00B2", "LPT\u00B3",
};

bool is_reserved(std::string_view name)
{
    return std::any_of(
        reserved_names.begin(), reserved_names.end(),
        [&](std::string_view reserved) { return is_same_ignoring_case(name, reserved); });
}

} // namespace

std::string default_file_name(std::string_view uri, const std::vector<std::string>& taken)
{
    const std::size_t slash = uri.rfind('/');
    std::string name{slash == std::string_view::npos ? uri : uri.substr(slash + 1)};
    name.erase(std::remove_if(
                   name.begin(), name.end(),
                   [](char c) { return prohibited_characters.find(c) != std::string_view::npos; }),
               name.end());
    if (is_reserved(name)) {
        name.clear();
    }
    const auto is_taken = [&](const std::string& wanted) {
        return std::any_of(taken.begin(), taken.end(), [&](const std::string& other) {
            return is_same_ignoring_case(wanted, other);
        });
    };
    std::string result = name;
    for (std::size_t i = 1; result.empty() || is_taken(result); ++i) {
        result = name + '_' + std::to_string(i);
    }
    return result;
}

} // namespace busbar::controller
