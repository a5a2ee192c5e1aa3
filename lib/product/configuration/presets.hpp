#pragma once

#include <span>
#include <string>
#include <string_view>

#include "config.hpp"

namespace busbar::product {

/// A setting that a preset leaves as it is by default, though the product's manual has another
/// default.
struct Departure {
    std::string_view setting;
    std::string_view manual;
    std::string_view section;
    std::string_view reason;
};

/// What a shipping product allows: all its published limits at once, the DataTypes of its variables
/// and what the certificate says that it makes by itself.
struct Preset {
    std::string_view name;
    /// Has the configuration say so.
    void (*take)(ControllerConfig& config);
    std::span<const Departure> departures;
};

/// "nj501, nx102 or rd81opc96".
inline constexpr std::string_view preset_names = "nj501, nx102 or rd81opc96";
/// Null if there is none of this name.
[[nodiscard]] const Preset* find_preset(std::string_view name);
/// Its figures, and where it departs from the manual, as one JSON object.
[[nodiscard]] std::string preset_json(const Preset& preset);
/// Prints that; 2 for a name that is none.
[[nodiscard]] int print_preset(const std::string& name);

} // namespace busbar::product
