#pragma once

#include <span>
#include <string>
#include <string_view>

#include "config.hpp"

namespace busbar::product {

/// A setting whose default a preset keeps, although the product's manual has another one.
struct Departure {
    std::string_view setting;
    std::string_view manual;
    std::string_view section;
    std::string_view reason;
};

/// The limits of a shipping product: all its published limits, the DataTypes of its variables and
/// the names in the certificate that it creates by default.
struct Preset {
    std::string_view name;
    /// Applies the preset to a configuration.
    void (*take)(ControllerConfig& config);
    std::span<const Departure> departures;
};

/// "nj501, nx102 or rd81opc96".
inline constexpr std::string_view preset_names = "nj501, nx102 or rd81opc96";
/// Finds a preset by name; null if there is none.
[[nodiscard]] const Preset* find_preset(std::string_view name);
/// Writes its figures, and its departures from the manual, as one JSON object.
[[nodiscard]] std::string preset_json(const Preset& preset);
/// Prints the preset; 2 for an unknown name.
[[nodiscard]] int print_preset(const std::string& name);

} // namespace busbar::product
