#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// Returns true if `text` matches `pattern` (Part 4, 7.7.3, Like): % stands for any characters, _
/// for one, [a-c] for one of a list, [^a-c] for one that is not in it, and \ makes the next
/// character literal. Characters are those of UTF-8; an invalid byte counts as one. A pattern with
/// an unterminated list or escape matches nothing.
///
/// Takes at most time proportional to text times pattern, and decrements `steps_left` for each
/// comparison; returns nothing if they were used up.
[[nodiscard]] std::optional<bool> is_like(std::string_view text, std::string_view pattern,
                                          std::size_t& steps_left);

/// The context of operators in addition to their operands.
struct FilterContext {
    const model::AddressSpace& space;
    model::NodeIndex event_type{model::no_node};
    /// The steps that one evaluation has left; an operator that needs more yields NULL.
    std::size_t steps_left{0};
};

/// The values of one element's operands; no pointer is null.
using FilterOperands = std::span<const Variant* const>;

/// An operator of a ContentFilter (Part 4, 7.7.3). Its result is a Boolean, or the result of Cast
/// and the bitwise operators; a null Variant is NULL, the third truth value.
struct FilterOperatorRule {
    FilterOperator id;
    std::uint8_t min_operands;
    std::uint8_t max_operands;
    /// Null for an operator that filters of events do not have.
    Variant (*evaluate)(FilterContext& context, FilterOperands operands);
};

/// Returns whether the operand is the NodeId of an event type.
[[nodiscard]] bool is_event_type(const model::AddressSpace& space, const Variant& operand);

/// Returns null for a number that is not an operator.
[[nodiscard]] const FilterOperatorRule* find_operator(FilterOperator id);

} // namespace busbar::server::detail
