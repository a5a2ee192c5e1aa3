#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/types/data_types.hpp>

/// Engineering units by the common codes of UNECE Recommendation 20, which OPC UA uses unless a
/// server says otherwise (Part 8, 5.6.3.4).
namespace busbar::model {

/// A unit of measurement; all texts are in UTF-8.
struct Unit {
    /// One to three characters, such as "CEL".
    std::string_view common_code;
    std::string_view symbol;
    std::string_view name;
};

/// Returns the UnitId of a common code; -1 for a text that is not a valid code.
[[nodiscard]] constexpr std::int32_t unit_id(std::string_view common_code)
{
    if (common_code.empty() || common_code.size() > 3) {
        return -1;
    }
    std::int32_t unit_id = 0;
    for (const char c : common_code) {
        if ((c < '0' || c > '9') && (c < 'A' || c > 'Z')) {
            return -1;
        }
        unit_id = unit_id * 256 + c;
    }
    return unit_id;
}

/// The units that controllers use most.
[[nodiscard]] BUSBAR_API std::span<const Unit> common_units();

/// Returns the EngineeringUnits value for one of common_units(). Any other common code yields its
/// UnitId, with the code as its symbol; an invalid code yields UnitId -1.
[[nodiscard]] BUSBAR_API EUInformation engineering_units(std::string_view common_code);
/// Returns the same for a unit that is not in the list.
[[nodiscard]] BUSBAR_API EUInformation engineering_units(const Unit& unit);

} // namespace busbar::model
