#pragma once

#include <cstdint>
#include <random>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/crypto/random.hpp>

namespace busbar::harness {

/// Repeats its numbers from a seed; never for keys that protect anything.
class BUSBAR_API SeededRandom final : public crypto::Random {
public:
    explicit SeededRandom(std::uint64_t seed = 1) : engine_{seed} {}

    Result<void> fill(std::span<std::byte> bytes) override
    {
        for (std::byte& byte : bytes) {
            byte = static_cast<std::byte>(engine_());
        }
        return {};
    }

private:
    std::mt19937_64 engine_;
};

} // namespace busbar::harness
