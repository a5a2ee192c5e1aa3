#include <cstdint>
#include <string_view>

#include "product/configuration/config.hpp"

namespace configuration_fuzz {

using namespace busbar;

/// Any text as the configuration of busbar-controller: it is one, or the error says where it is
/// not.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    try {
        static_cast<void>(product::parse_config(text, "fuzz.toml"));
    } catch (const product::ConfigError& error) {
        if (error.problem().where.empty() && error.problem().text.empty()) {
            __builtin_trap();
        }
    }
    return 0;
}

} // namespace configuration_fuzz
