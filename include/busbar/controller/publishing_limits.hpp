#pragma once

#include <cstdint>
#include <optional>

#include <busbar/core/api.hpp>

namespace busbar::controller {

/// Limits the published variables of a program that are visible to clients. By default all are;
/// an empty value means no limit.
struct PublishingLimits {
    // Limits of all variables together.
    std::optional<std::uint64_t> max_variables{};
    std::optional<std::uint64_t> max_values{};
    /// Structure definitions.
    std::optional<std::uint64_t> max_data_types{};

    // Limits of each variable.
    /// In bytes, as in ProgramTypes::size_of.
    std::optional<std::uint64_t> max_size{};
    /// Elements of an array variable, over all its dimensions.
    std::optional<std::uint64_t> max_elements{};
    /// Members of the variable's structure, without those of nested ones.
    std::optional<std::uint64_t> max_members{};
    /// Nested structures, including the outermost.
    std::optional<std::uint64_t> max_levels{};
    /// Arrays whose first index is not 0, also in structures. Clients count from 0 in any case.
    bool allows_any_first_index{true};
    /// Arrays of structures with several dimensions, and such arrays of any type in structures.
    bool allows_matrices_with_structures{true};
    bool allows_unions{true};

    friend bool operator==(const PublishingLimits&, const PublishingLimits&) = default;
};

/// NJ501 (W588, 1-2-2): 10,000 variables, 10,000 values, 100 structure
/// definitions; 1,024 bytes, 1,024 elements, 100 members and three levels of each; no first index
/// other than 0, no matrices with structures, no unions. The same for NX102.
[[nodiscard]] BUSBAR_API PublishingLimits nj501_publishing();
[[nodiscard]] BUSBAR_API PublishingLimits nx102_publishing();

} // namespace busbar::controller
