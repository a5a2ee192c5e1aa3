#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/password_hash.hpp>

#include "config.hpp"

/// The sections of a configuration file, in the order in which config.cpp reads them; most need
/// what was read before. All throw ConfigError.
namespace busbar::product {

/// `preset` or `memory` of [limits], before all else.
void read_preset(const TomlTable& root, ControllerConfig& config);

/// [certificates]
void read_certificates(const TomlTable& table, ControllerConfig& config);
/// [[files]]: no folder of files may have the certificates' keys in it.
[[nodiscard]] std::vector<FilesConfig> read_files(const TomlTable& root,
                                                  const CertificateConfig& certificates);

/// The rest of [limits], and [users.passwords].
void read_limits(const TomlTable& root, ControllerConfig& config);
/// What array_length can be raised to.
inline constexpr std::int64_t most_elements = 16'777'216;
/// Refuses a variable whose whole value would not go through these limits.
void check_size(const TomlTable& entry, const controller::PlcVariable& variable,
                const server::ServerLimits& limits);

/// [users]
void read_users(const TomlTable& table, ControllerConfig& config);
/// Of [users]: what hashes of passwords cost that are made from now on.
[[nodiscard]] crypto::PasswordCost read_password_cost(const TomlTable& table);
/// Some of the well-known roles that a login gives nobody by itself (Part 3, 4.9.2).
[[nodiscard]] std::vector<std::string> read_roles(const TomlTable& table, std::string_view key,
                                                  std::vector<std::string> otherwise);

/// [[endpoint]], or [security], which says it in the products' ways; what neither says is the
/// default. Endpoints offer what kinds of users there are.
void read_endpoints(const TomlTable& root, ControllerConfig& config);

/// [machine], with the program that it names. Problems of the program's file have its name, line
/// and column.
void read_machine(const TomlTable& table, ControllerConfig& config);
/// The DataTypes of variables where neither a preset nor the configuration says: those of PLCopen,
/// if this build has them.
[[nodiscard]] controller::MachineTypeOptions default_types();

/// [labels], with the program that it names. Problems of the program's file have its name, line and
/// column.
void read_labels(const TomlTable& table, ControllerConfig& config);
/// The labels of a PLC that does not scan yet; none without a program.
[[nodiscard]] std::unique_ptr<controller::SimulatedLabels> make_labels(const LabelConfig& config);

/// [plc] with its variables and programs, checked by building the PLC once.
void read_plc(const TomlTable& table, ControllerConfig& config);

} // namespace busbar::product
