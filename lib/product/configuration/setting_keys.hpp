#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/setting_list.hpp>

#include "config.hpp"
#include "subject_names.hpp"
#include "toml_reader.hpp"

namespace busbar::product {

/// Everything of a configuration that administrators may change online: a setting has the name of
/// its key, "limits.subscriptions.items". Accounts and tokens are not among them, which have hashes
/// and keys, nor the folder of certificates, in which the changes lie, nor the folders of files:
/// what clients reach of the machine is decided on the machine.
///
/// The limits' defaults are those of the file's preset. Throws a ConfigError if there is none of
/// its name.
[[nodiscard]] std::vector<administration::Setting> controller_settings(const toml::table& file);

/// The endpoints as the setting of this name has them, whichever way a file says it.
[[nodiscard]] Variant endpoint_value(const server::ServerConfig& config);
[[nodiscard]] std::string setting_name(const SubjectKey& key);
/// True if the key stands for a list of tables, [[plc.variable]]: its value is a list of texts,
/// each an inline table: `{ name = "Speed", type = "Int16" }`.
[[nodiscard]] bool is_table_list(std::string_view name);
/// True for what is of the security profile (W588, 3-2-6): who may come in, and how his
/// messages are protected.
[[nodiscard]] bool is_security_setting(std::string_view name);
/// True if a change is in force at once.
[[nodiscard]] bool is_live(std::string_view name);

/// Where a manual or the standard says what a key is to be.
struct Rule {
    /// "server.port"; with a star at its end all that begin like this.
    std::string_view key;
    std::string_view source;
};
[[nodiscard]] std::span<const Rule> rules();

} // namespace busbar::product
