#pragma once

#include <string>

#include <busbar/administration/setting_list.hpp>

#include "toml.hpp"

namespace busbar::product {

/// Puts what was changed online over what a file says. Throws a ConfigError that names the setting
/// where a text is no inline table.
void overlay(toml::table& file, const administration::SettingValues& changes);

/// The value of a key, as the setting has it; null if the file has none, or one of another type.
[[nodiscard]] Variant value_in(const toml::table& file, const administration::Setting& setting);

/// The value of a setting, for people: 7, true, "text", [1, 2].
[[nodiscard]] std::string value_text(const Variant& value);

} // namespace busbar::product
