#pragma once

#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include <busbar/core/clock.hpp>

namespace busbar::harness {

/// The randomness of a world: the same numbers on every machine, and a stream for each actor, so
/// that numbers drawn by one actor do not change those of the others. Consecutive seeds and streams
/// have nothing in common.
class Chance {
public:
    Chance(std::uint64_t seed, std::uint64_t stream) : state_{mixed(mixed(seed + step) + stream)} {}

    /// SplitMix64.
    std::uint64_t next() { return mixed(state_ += step); }
    /// Returns 0 to `count` - 1.
    [[nodiscard]] std::size_t below(std::size_t count) { return next() % count; }
    /// True in one of `count` cases, on average.
    [[nodiscard]] bool one_in(std::size_t count) { return below(count) == 0; }
    /// Returns a duration between both, inclusive. Throws std::invalid_argument if the first one is
    /// the longer.
    [[nodiscard]] Duration between(Duration least, Duration most)
    {
        if (most < least) {
            throw std::invalid_argument{"a random duration cannot be at least " +
                                        std::to_string(least.count()) + " ns and at most " +
                                        std::to_string(most.count()) + " ns"};
        }
        const auto range = static_cast<std::uint64_t>((most - least).count()) + 1;
        return least + Duration{static_cast<std::int64_t>(next() % range)};
    }
    /// Returns one of the values.
    template <typename T>
    [[nodiscard]] T pick(std::initializer_list<T> values)
    {
        return values.begin()[below(values.size())];
    }

private:
    static constexpr std::uint64_t step = 0x9E37'79B9'7F4A'7C15U;

    [[nodiscard]] static std::uint64_t mixed(std::uint64_t z)
    {
        z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9U;
        z = (z ^ (z >> 27U)) * 0x94D0'49BB'1331'11EBU;
        return z ^ (z >> 31U);
    }

    std::uint64_t state_;
};

} // namespace busbar::harness
