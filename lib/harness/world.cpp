#include <busbar/harness/world.hpp>

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace busbar::harness {

std::uint64_t World::seed_from_environment()
{
    std::uint64_t seed = 1;
    if (const char* const variable = std::getenv("BUSBAR_SEED")) {
        const std::string_view text{variable};
        std::from_chars(text.data(), text.data() + text.size(), seed);
    }
    return seed;
}

} // namespace busbar::harness
