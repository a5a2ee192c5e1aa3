#pragma once

#include <string>
#include <string_view>

namespace busbar::controller::detail {

/// Returns the step that a field adds to a path: ".Name". Escapes separators in the name by
/// backslashes, so that a field "A.B" is not taken for B of a field "A".
[[nodiscard]] inline std::string field_step(std::string_view name)
{
    std::string step{'.'};
    for (const char c : name) {
        if (c == '.' || c == '[' || c == ']' || c == '\\') {
            step += '\\';
        }
        step += c;
    }
    return step;
}

} // namespace busbar::controller::detail
