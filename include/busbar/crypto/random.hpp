#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>

namespace busbar::crypto {

/// The source of nonces, tokens and ids; injected so that a test can repeat a run.
class BUSBAR_API Random {
public:
    Random() = default;
    Random(const Random&) = delete;
    Random& operator=(const Random&) = delete;
    virtual ~Random() = default;

    /// Fills `bytes` with unpredictable ones; Bad_ResourceUnavailable if the source has none.
    [[nodiscard]] virtual Result<void> fill(std::span<std::byte> bytes) = 0;
};

/// OpenSSL's generator. Called from any thread.
class BUSBAR_API SystemRandom final : public Random {
public:
    [[nodiscard]] Result<void> fill(std::span<std::byte> bytes) override;
};

/// Mixes bytes into OpenSSL's generator; they never make it less random, whatever they are.
BUSBAR_API void add_entropy(std::span<const std::byte> bytes);

} // namespace busbar::crypto
