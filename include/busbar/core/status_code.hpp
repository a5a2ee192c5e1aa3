#pragma once

#include <cstdint>

namespace busbar {

/// A StatusCode (Part 4, 7.38): severity in bits 30-31, sub code in 16-27, info bits in 0-15.
class StatusCode {
public:
    constexpr StatusCode() = default;
    constexpr explicit StatusCode(std::uint32_t value) : value_{value} {}

    [[nodiscard]] constexpr std::uint32_t value() const { return value_; }
    [[nodiscard]] constexpr bool is_good() const { return (value_ >> 30U) == 0; }
    [[nodiscard]] constexpr bool is_uncertain() const { return (value_ >> 30U) == 1; }
    /// Severity 3 is reserved and treated as bad (Part 4, 7.38.1).
    [[nodiscard]] constexpr bool is_bad() const { return value_ >= 0x80000000U; }
    /// Severity and sub code, without structure-changed, semantics-changed, limit and overflow
    /// bits.
    [[nodiscard]] constexpr StatusCode code() const { return StatusCode{value_ & 0xFFFF0000U}; }

    friend constexpr bool operator==(StatusCode, StatusCode) = default;

private:
    std::uint32_t value_{0};
};

} // namespace busbar
