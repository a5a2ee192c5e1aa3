#pragma once

#include <string>

namespace busbar::product {

/// Implements --hash-password: reads a password from standard input and prints its hash for a
/// configuration. The cost is that in [users] of `config_file`, which may otherwise be invalid; ""
/// is the built-in configuration. Returns the program's exit code; throws ConfigError.
[[nodiscard]] int hash_password(const std::string& config_file);

} // namespace busbar::product
