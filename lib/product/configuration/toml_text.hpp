#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/core/expected.hpp>

#include "toml.hpp"

namespace busbar::product {

struct TomlProblem {
    std::size_t line{1}; // counted from 1
    std::string text;
};

/// Parses a TOML text. Characters beyond ASCII are allowed in strings and comments only, as in TOML
/// 1.0.
[[nodiscard]] Expected<toml::table, TomlProblem> parse_toml(std::string_view text);

} // namespace busbar::product
