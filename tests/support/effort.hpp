#pragma once

#include <cstddef>
#include <cstdlib>
#include <string>
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

/// Index of the part, below `parts`, that a test of this name does unless the effort is full. It
/// differs from name to name and with the number BUSBAR_TEST_ROUND in the environment, 0 if there
/// is none, which `tests/run` counts up every day. After `parts` rounds each part has had its turn.
[[nodiscard]] inline std::size_t part_of_round(std::string_view name, std::size_t parts)
{
    const char* const round = std::getenv("BUSBAR_TEST_ROUND");
    const std::size_t number = round != nullptr ? std::stoul(round) : 0;
    return (std::hash<std::string_view>{}(name) % parts + number) % parts;
}

/// Which of very many cases, such as a power cut after each step, a test does: all at full effort,
/// otherwise every `parts`-th, beginning with another one every day.
struct Turns {
    Turns(std::string_view name, std::size_t parts)
        : stride{is_full_effort() ? 1 : parts}, first{part_of_round(name, stride)}
    {
    }

    std::size_t stride;
    std::size_t first;
};

} // namespace busbar::test
