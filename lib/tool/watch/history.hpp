#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <busbar/core/types.hpp>

namespace busbar::tool::watch {

/// The last numbers that a Variable had.
class History {
public:
    static constexpr std::size_t capacity = 120;
    static constexpr std::uint8_t highest_level = 8;

    /// The oldest gives way. NaN and infinite numbers leave a hole.
    void add(double number);
    [[nodiscard]] bool is_empty() const { return numbers_.empty(); }
    /// The newest numbers, at most `width`, oldest first: 1 for the least of them to highest_level
    /// for the greatest, 0 for a hole. All 1 if they are the same.
    [[nodiscard]] std::vector<std::uint8_t> levels(std::size_t width) const;

private:
    std::deque<double> numbers_;
};

/// Returns the value as a number; nothing for a Boolean, an array or any other type.
[[nodiscard]] std::optional<double> number_of(const Variant& value);

} // namespace busbar::tool::watch
