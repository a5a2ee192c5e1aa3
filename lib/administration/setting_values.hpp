#pragma once

#include <optional>
#include <string>

#include <busbar/administration/setting_list.hpp>

#include "json_file.hpp"

/// Converts values of settings from and to JSON.
namespace busbar::administration::detail {

void write_value(JsonWriter& json, const Variant& value);
/// Converts to the type that `like` has; nothing if the JSON has another type.
[[nodiscard]] std::optional<Variant> value_of(const Json& json, const Variant& like);
/// Writes a value for people: "5", "true", "\"Press 4\"", "[1, 2]".
[[nodiscard]] std::string shown(const Variant& value);
/// Describes the type: "a whole number", "a list of texts".
[[nodiscard]] std::string kind_of(const Variant& like);

} // namespace busbar::administration::detail
