#pragma once

#include <string>

namespace busbar::product {

/// --hash-password: reads a password from standard input, prints what a configuration may store.
/// What it costs is what [users] of `config_file` says, in which nothing else has to make sense
/// yet; "" is the built-in one. The program's exit code; throws ConfigError.
[[nodiscard]] int hash_password(const std::string& config_file);

} // namespace busbar::product
