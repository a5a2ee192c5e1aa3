#pragma once

#include <optional>
#include <string>

#include <busbar/administration/setting_list.hpp>

#include "json_file.hpp"

/// Values of settings as JSON has them.
namespace busbar::administration::detail {

void write_value(JsonWriter& json, const Variant& value);
/// The value with the type that `like` has; nothing if the JSON is no such one.
[[nodiscard]] std::optional<Variant> value_of(const Json& json, const Variant& like);
/// For people: "5", "true", "\"Press 4\"", "[1, 2]".
[[nodiscard]] std::string shown(const Variant& value);
/// "a whole number", "a list of texts".
[[nodiscard]] std::string kind_of(const Variant& like);

} // namespace busbar::administration::detail
