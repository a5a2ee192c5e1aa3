#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

namespace busbar::test {

/// What a variable of the environment says, which is a whole number.
[[nodiscard]] inline std::uint64_t number_from(const char* variable, std::uint64_t otherwise)
{
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::stoull(text) : otherwise;
}

[[nodiscard]] inline std::uint64_t simulation_seed()
{
    return number_from("BUSBAR_SIMULATION_SEED", 1);
}

} // namespace busbar::test
