#pragma once

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "support/effort.hpp"

namespace busbar::test {

/// What a variable of the environment says, which is a whole number.
[[nodiscard]] inline std::uint64_t number_from(const char* variable, std::uint64_t otherwise)
{
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::stoull(text) : otherwise;
}

/// Hours of virtual time: BUSBAR_SIMULATION_HOURS, or a day at full effort, or `otherwise`.
[[nodiscard]] inline std::uint64_t simulation_hours(std::uint64_t otherwise)
{
    return number_from("BUSBAR_SIMULATION_HOURS", is_full_effort() ? 24 : otherwise);
}

/// The same, for less than an hour.
[[nodiscard]] inline std::chrono::minutes simulation_time(std::chrono::minutes otherwise)
{
    const std::uint64_t hours = simulation_hours(0);
    return hours != 0 ? std::chrono::hours{hours} : otherwise;
}

[[nodiscard]] inline std::uint64_t simulation_seed()
{
    return number_from("BUSBAR_SIMULATION_SEED", 1);
}

} // namespace busbar::test
