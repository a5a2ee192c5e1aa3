#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace busbar::server::detail {

/// The work that is done for one connection before others have their turn.
///
/// Counted in units and not by a clock, so that a simulation sees the same. A unit is some
/// nanoseconds: decoding or encoding a byte, visiting a reference.
class Turn {
public:
    /// Less than a millisecond: twenty busy connections delay another one by less than 20.
    static constexpr std::size_t units = 30'000;
    static constexpr std::size_t units_of_request = 200;
    /// Cost of looking up a node with its value.
    static constexpr std::size_t units_of_value = 10;
    /// Cost of a ReferenceDescription.
    static constexpr std::size_t units_of_reference = 50;
    /// Cost of creating or changing a MonitoredItem.
    static constexpr std::size_t units_of_item = 1'000;

    /// A turn without an end.
    constexpr Turn() = default;
    constexpr explicit Turn(std::size_t units_left) : left_{units_left} {}

    constexpr void spend(std::size_t count) { left_ -= std::min(count, left_); }
    [[nodiscard]] constexpr std::size_t left() const { return left_; }
    [[nodiscard]] constexpr bool is_over() const { return left_ == 0; }
    /// Returns the turn of work that had to be done again `times` times: it doubles each time, so
    /// that the work ends whatever happens between its turns.
    [[nodiscard]] constexpr Turn prolonged(unsigned times) const
    {
        const bool is_endless = left_ > (std::numeric_limits<std::size_t>::max() >> times);
        return is_endless ? Turn{} : Turn{left_ << times};
    }
    /// Spends what was spent of `longer`, the result of prolonged().
    constexpr void spend_as(const Turn& longer, unsigned times) { left_ = longer.left_ >> times; }

private:
    std::size_t left_{std::numeric_limits<std::size_t>::max()};
};

} // namespace busbar::server::detail
