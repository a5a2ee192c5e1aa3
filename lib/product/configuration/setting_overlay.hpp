#pragma once

#include <string>

#include <busbar/administration/setting_list.hpp>

#include "toml.hpp"

namespace busbar::product {

/// Applies online changes to a file's table. Throws a ConfigError with the setting if a text is not
/// an inline table.
void overlay(toml::table& file, const administration::SettingValues& changes);

/// The value of a key in the form of the setting; null if the file does not have it, or has another
/// type.
[[nodiscard]] Variant value_in(const toml::table& file, const administration::Setting& setting);

/// Writes a setting's value for people: 7, true, "text", [1, 2].
[[nodiscard]] std::string value_text(const Variant& value);

} // namespace busbar::product
