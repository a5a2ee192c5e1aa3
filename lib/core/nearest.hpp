#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// The candidates that `word` may be a misspelling of, the likeliest first; empty if none is near.
[[nodiscard]] BUSBAR_API std::vector<std::string>
nearest(std::string_view word, const std::vector<std::string>& candidates);

} // namespace busbar::detail
