#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace busbar::server::detail {

/// The work that is done for one connection before others have their turn.
///
/// Counted in units and not by a clock, so that a simulation sees the same. A unit is some
/// nanoseconds: a byte that is decoded or encoded, a reference that is looked at.
class Turn {
public:
    /// Less than a millisecond: twenty greedy connections keep another waiting for less than 20.
    static constexpr std::size_t units = 30'000;
    static constexpr std::size_t units_of_request = 200;
    /// A node whose value is looked up.
    static constexpr std::size_t units_of_value = 10;
    /// A ReferenceDescription that is made.
    static constexpr std::size_t units_of_reference = 50;
    /// A MonitoredItem that is made or changed.
    static constexpr std::size_t units_of_item = 1'000;

    /// Without an end.
    constexpr Turn() = default;
    constexpr explicit Turn(std::size_t units_left) : left_{units_left} {}

    constexpr void spend(std::size_t count) { left_ -= std::min(count, left_); }
    [[nodiscard]] constexpr std::size_t left() const { return left_; }
    [[nodiscard]] constexpr bool is_over() const { return left_ == 0; }

private:
    std::size_t left_{std::numeric_limits<std::size_t>::max()};
};

} // namespace busbar::server::detail
