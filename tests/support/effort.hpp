#pragma once

#include <cstdlib>
#include <string_view>

namespace busbar::test {

/// True if BUSBAR_TEST_EFFORT is "full", as `tests/run all` sets it. Otherwise a test that repeats
/// one thing very often, such as a simulated hour or a failing allocation, does a part of it, so
/// that every test of a configuration ends within minutes.
[[nodiscard]] inline bool is_full_effort()
{
    const char* const effort = std::getenv("BUSBAR_TEST_EFFORT");
    return effort != nullptr && std::string_view{effort} == "full";
}

} // namespace busbar::test
