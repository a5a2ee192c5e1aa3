#pragma once

#include <busbar/crypto/password_hash.hpp>

#include "config.hpp"

namespace busbar::product {

/// [certificates]
void read_certificates(const TomlTable& table, ControllerConfig& config);
/// Some of the well-known roles that a login gives nobody by itself (Part 3, 4.9.2).
[[nodiscard]] std::vector<std::string> read_roles(const TomlTable& table, std::string_view key,
                                                  std::vector<std::string> otherwise);
/// Of [users]: what hashes of passwords cost that are made from now on.
[[nodiscard]] crypto::PasswordCost read_password_cost(const TomlTable& table);
/// [users]
void read_users(const TomlTable& table, ControllerConfig& config);

} // namespace busbar::product
