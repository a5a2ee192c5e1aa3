#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/password_hash.hpp>

#include "config.hpp"

/// Reads the sections of a configuration file, in the order in which config.cpp calls these; most
/// need the results of earlier ones. All throw ConfigError.
namespace busbar::product {

/// Reads `preset` or `memory` of [limits], before everything else.
void read_preset(const TomlTable& root, ControllerConfig& config);

/// Reads [certificates].
void read_certificates(const TomlTable& table, ControllerConfig& config);
/// Reads [[files]]. No folder of files may contain the certificates' keys.
[[nodiscard]] std::vector<FilesConfig> read_files(const TomlTable& root,
                                                  const CertificateConfig& certificates);

/// Refuses folders with files that are not for clients: the configuration, the programs of the
/// machine and of the labels, the passwords of PLCs, and what the machine keeps. Call it after
/// everything is read.
void check_files(const TomlTable& root, const ControllerConfig& config);

/// Reads the rest of [limits], and [users.passwords].
void read_limits(const TomlTable& root, ControllerConfig& config);
/// Upper limit of array_length.
inline constexpr std::int64_t most_elements = 16'777'216;
/// Refuses a variable whose whole value would exceed these limits.
void check_size(const TomlTable& entry, const controller::PlcVariable& variable,
                const server::ServerLimits& limits);

/// Reads [users].
void read_users(const TomlTable& table, ControllerConfig& config);
/// Reads the cost of new hashes of passwords in [users].
[[nodiscard]] crypto::PasswordCost read_password_cost(const TomlTable& table);
/// Reads names of well-known roles, without those that every login gives (Part 3, 4.9.2).
[[nodiscard]] std::vector<std::string> read_roles(const TomlTable& table, std::string_view key,
                                                  std::vector<std::string> otherwise);

/// Reads [[endpoint]], or [security], which is the products' form of it; without both the default
/// stays. Endpoints offer the kinds of user that are configured.
void read_endpoints(const TomlTable& root, ControllerConfig& config);

/// Reads [machine] with the program that it names. Problems in the program's file have its name,
/// line and column.
void read_machine(const TomlTable& table, ControllerConfig& config);
/// The DataTypes of variables without a preset or configuration: those of PLCopen, if this build
/// has them.
[[nodiscard]] controller::MachineTypeOptions default_types();

/// Reads [labels] with the program that it names. Problems in the program's file have its name,
/// line and column.
void read_labels(const TomlTable& table, ControllerConfig& config);
/// Creates the labels of a PLC that does not scan yet; null without a program.
[[nodiscard]] std::unique_ptr<controller::SimulatedLabels> make_labels(const LabelConfig& config);

/// Reads [plc] with its variables and programs, and checks them by building the PLC once.
void read_plc(const TomlTable& table, ControllerConfig& config);

} // namespace busbar::product
