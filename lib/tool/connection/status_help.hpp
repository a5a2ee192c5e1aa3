#pragma once

#include <string_view>

#include <busbar/core/status_code.hpp>

namespace busbar::tool {

/// A StatusCode in plain words; both are empty for one that has none here.
struct StatusHelp {
    std::string_view meaning;
    /// Advice for the user; may be empty.
    std::string_view hint;
};

[[nodiscard]] StatusHelp help_for(StatusCode status);

} // namespace busbar::tool
