#include <algorithm>

#include <busbar/controller/value_shape.hpp>

namespace busbar::controller {

namespace {

// ValueRank (Part 3, 5.6.2).
constexpr std::int32_t scalar_or_one_dimension = -3;
constexpr std::int32_t any = -2;
constexpr std::int32_t scalar = -1;
constexpr std::int32_t one_or_more_dimensions = 0;

constexpr std::size_t max_rank = 3;

/// `limit` + 1 for more.
std::size_t product(std::span<const std::uint32_t> dimensions, std::size_t limit)
{
    std::size_t result = 1;
    for (const std::uint32_t dimension : dimensions) {
        result = dimension != 0 && result > limit / dimension ? limit + 1 : result * dimension;
    }
    return result;
}

/// Tells whether a MappingArray may choose `rank` for a ValueRank that leaves the rank open.
bool allows(std::int32_t value_rank, std::int32_t rank)
{
    if (rank == scalar) {
        return value_rank != one_or_more_dimensions;
    }
    return rank == 1 ||
           (rank > 1 && rank <= std::int32_t{max_rank} && value_rank != scalar_or_one_dimension);
}

/// Takes over the chosen dimensions: 1 for one that is 0 or too large, and 1 for all of them if the
/// array would have too many elements.
void choose_dimensions(const MappingArray& chosen, const ShapeLimits& limits, ArrayForm& form)
{
    for (std::size_t i = 0; i < form.rank; ++i) {
        const std::uint32_t dimension = chosen.dimensions[i];
        form.dimensions[i] = dimension == 0 || dimension > limits.max_elements ? 1 : dimension;
    }
    if (product(form.dimensions, limits.max_elements) > limits.max_elements) {
        form.dimensions = {1, 1, 1};
    }
}

ArrayForm limited(std::uint8_t rank, const MappingArray* chosen, bool is_argument,
                  const ShapeLimits& limits)
{
    if (is_argument) {
        return {};
    }
    ArrayForm form;
    form.use = ArrayUse::Limited;
    form.rank = rank;
    form.is_open = chosen == nullptr;
    if (chosen != nullptr) {
        choose_dimensions(*chosen, limits, form);
    }
    return form;
}

ArrayForm fixed(std::span<const std::uint32_t> dimensions, const ShapeLimits& limits)
{
    ArrayForm form;
    form.is_too_large = product(dimensions, limits.max_elements) > limits.max_elements;
    if (!form.is_too_large) {
        form.use = ArrayUse::Yes;
        form.rank = static_cast<std::uint8_t>(dimensions.size());
        std::copy(dimensions.begin(), dimensions.end(), form.dimensions.begin());
    }
    return form;
}

} // namespace

ArrayForm array_form(std::int32_t value_rank, std::span<const std::uint32_t> array_dimensions,
                     const MappingArray* chosen, bool is_argument, const ShapeLimits& limits)
{
    switch (value_rank) {
    case scalar:
        return fixed({}, limits);
    case scalar_or_one_dimension:
    case any:
    case one_or_more_dimensions: {
        const bool is_chosen = chosen != nullptr && allows(value_rank, chosen->rank);
        const std::int32_t rank = is_chosen ? std::max(chosen->rank, 0) : 1;
        return limited(static_cast<std::uint8_t>(rank), is_chosen ? chosen : nullptr, is_argument,
                       limits);
    }
    case 1:
    case 2:
    case 3:
        break;
    default:
        return {};
    }
    const auto rank = static_cast<std::uint8_t>(value_rank);
    const auto open = std::count(array_dimensions.begin(), array_dimensions.end(), 0U);
    if (array_dimensions.empty() || (array_dimensions.size() == rank && open == value_rank)) {
        return limited(rank, chosen, is_argument, limits);
    }
    return array_dimensions.size() == rank && open == 0 ? fixed(array_dimensions, limits)
                                                        : ArrayForm{};
}

} // namespace busbar::controller
