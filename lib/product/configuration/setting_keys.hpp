#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/setting_list.hpp>
#include <busbar/core/problem.hpp>

#include "config.hpp"
#include "subject_names.hpp"
#include "toml.hpp"
#include "toml_reader.hpp"

namespace busbar::product {

/// All parts of a configuration that administrators may change online; a setting has the name of
/// its key, "limits.subscriptions.items". Accounts and tokens are not included, because they have
/// hashes and keys, nor are the folder of certificates, which contains the changes, and the folders
/// of files: the machine's own configuration decides which of its files clients reach.
///
/// Defaults of limits are those of the file's preset. Throws a ConfigError if there is no such
/// preset.
[[nodiscard]] std::vector<administration::Setting> controller_settings(const toml::table& file);

/// The endpoints in the form of the setting of this name, in whichever form the file has them.
[[nodiscard]] Variant endpoint_value(const server::ServerConfig& config);
[[nodiscard]] std::string setting_name(const SubjectKey& key);
/// True if the key stands for a list of tables, such as [[plc.variable]]; its value is a list of
/// texts, each an inline table: `{ name = "Speed", type = "Int16" }`.
[[nodiscard]] bool is_table_list(std::string_view name);
/// True for a setting of the security profile (W588, 3-2-6): access of users, and protection of
/// messages.
[[nodiscard]] bool is_security_setting(std::string_view name);
/// True if a change takes effect at once.
[[nodiscard]] bool is_live(std::string_view name);

/// A rule for a key in a manual or the standard.
struct Rule {
    /// "server.port"; a star at its end stands for all keys with that beginning.
    std::string_view key;
    std::string_view source;
};
[[nodiscard]] std::span<const Rule> rules();

/// Settings that a machine accepts in PROGRAM mode only: those of its server and its security
/// (W588, 3-2-2 and 3-2-6: "Changes in RUN mode").
[[nodiscard]] std::span<const std::string_view> program_only_settings();

/// Checks a change on a machine in RUN: Bad_InvalidState, with the name, if one of those settings
/// differs between `now` and `next`.
[[nodiscard]] Configured<void> check_in_run(const administration::SettingValues& now,
                                            const administration::SettingValues& next);

/// The same for a file that is read again, with its tables as `now` and `next`. Checks only its
/// security ([users], [[endpoint]] and [security]), which takes effect at once; the other settings
/// wait for a restart.
[[nodiscard]] Configured<void> check_file_in_run(const toml::table& now, const toml::table& next);

/// The problem with a change on a machine in RUN.
[[nodiscard]] Unexpected<Problem> refused_in_run(std::string what);

/// Applies online changes to a file's table. Throws a ConfigError with the setting if a text is not
/// an inline table.
void overlay(toml::table& file, const administration::SettingValues& changes);

/// The value of a key in the form of the setting; null if the file does not have it, or has another
/// type.
[[nodiscard]] Variant value_in(const toml::table& file, const administration::Setting& setting);

/// Writes a setting's value for people: 7, true, "text", [1, 2].
[[nodiscard]] std::string value_text(const Variant& value);

} // namespace busbar::product
