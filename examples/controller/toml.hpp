#pragma once

#include <stdexcept>

namespace busbar::example {

/// toml++ (to 3.3) has met a text that it had taken to be impossible, as "[#" is. It would end the
/// program, or go on with a promise to the compiler that does not hold.
struct TomlFailure : std::logic_error {
    TomlFailure() : std::logic_error{"toml++ cannot read this"} {}
};

constexpr void check_toml(bool condition)
{
    if (!condition) {
        throw TomlFailure{};
    }
}

} // namespace busbar::example

// The only place that includes it, so that all see the same.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) ::busbar::example::check_toml(static_cast<bool>(condition))
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
