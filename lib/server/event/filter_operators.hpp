#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// What operators may ask for beside their operands.
struct FilterContext {
    const model::AddressSpace& space;
    model::NodeIndex event_type{model::no_node};
    /// The work that one evaluation may still be; an operator that needs more yields NULL.
    std::size_t steps_left{0};
};

/// The values of one element's operands; none is a null pointer.
using FilterOperands = std::span<const Variant* const>;

/// An operator of a ContentFilter (Part 4, 7.7.3). Its result is a Boolean, or what Cast and the
/// bitwise operators compute; a null Variant is NULL, the third truth value.
struct FilterOperatorRule {
    FilterOperator id;
    std::uint8_t min_operands;
    std::uint8_t max_operands;
    /// Null for an operator that filters of events do not have.
    Variant (*evaluate)(FilterContext& context, FilterOperands operands);
};

/// Null for a number that is no operator.
[[nodiscard]] const FilterOperatorRule* find_operator(FilterOperator id);

} // namespace busbar::server::detail
