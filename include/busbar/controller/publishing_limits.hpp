#pragma once

#include <cstdint>
#include <optional>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// Which of the variables that a program publishes clients get to see. By default all of them;
/// nothing given: no limit.
struct PublishingLimits {
    // Of all variables together.
    std::optional<std::uint64_t> max_variables{};
    std::optional<std::uint64_t> max_values{};
    /// Structure definitions.
    std::optional<std::uint64_t> max_data_types{};

    // Of each variable.
    /// Bytes, as ProgramTypes::size_of counts them.
    std::optional<std::uint64_t> max_size{};
    /// Of an array variable, over all its dimensions.
    std::optional<std::uint64_t> max_elements{};
    /// Of the structure that the variable is of, not of those within it.
    std::optional<std::uint64_t> max_members{};
    /// Structures within one another, the outermost included.
    std::optional<std::uint64_t> max_levels{};
    /// Arrays whose first index is not 0, also in structures. Clients count from 0 in any case.
    bool allows_any_first_index{true};
    /// Arrays of structures with several dimensions, and such arrays of anything in structures.
    bool allows_matrices_with_structures{true};
    bool allows_unions{true};

    friend bool operator==(const PublishingLimits&, const PublishingLimits&) = default;
};

/// NJ501 (seed 000, 1-2-2): 10,000 variables, 10,000 values, 100 structure definitions; 1,024
/// bytes, 1,024 elements, 100 members and three levels of each; no other first index than 0, no
/// matrices with structures, no unions. The same for NX102.
[[nodiscard]] BUSBAR_API PublishingLimits nj501_publishing();
[[nodiscard]] BUSBAR_API PublishingLimits nx102_publishing();

} // namespace busbar::controller
