#include "print_capacities.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "product/configuration/limit_keys.hpp"
#include "product/configuration/memory_section.hpp"

namespace busbar::product {

namespace {

/// Writes a number as "65,535".
std::string with_commas(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) {
        at -= 3;
        text.insert(at, ",");
    }
    return text;
}

} // namespace

std::string describe_capacities(const ControllerConfig& config)
{
    std::string text = "| at most | | key in `[limits]` |\n|---|---|---|\n";
    for (const LimitKey* const key : limits_in(&LimitKey::capacity)) {
        const auto value = static_cast<std::uint64_t>(key->get(config));
        text += "| " + std::string{key->capacity.name} + " | " +
                (key->unit == "B" ? size_text(value) : with_commas(value)) + " | `" +
                key_of(key->cost) + "` |\n";
    }
    return text;
}

int print_capacities(const std::string& file)
{
    std::fputs(describe_capacities(read_config_or_default(file)).c_str(), stdout);
    return 0;
}

} // namespace busbar::product
