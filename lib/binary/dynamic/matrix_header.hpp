#pragma once

#include <algorithm>
#include <cstdint>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/binary/reader.hpp>

namespace busbar::binary::detail {

/// `count` times `dimension`, `limit` + 1 past the limit; 0 stays 0.
[[nodiscard]] constexpr std::size_t times_dimension(std::size_t count, std::uint32_t dimension,
                                                    std::size_t limit)
{
    if (dimension == 0 || count == 0) {
        return 0;
    }
    return count > limit / dimension ? limit + 1 : count * dimension;
}

/// Reads the dimensions before a matrix (Part 6, 5.2.5) and passes each to `take`. Returns the
/// number of elements, checked as an array's count is; -1 for a null matrix and after an error.
template <typename Take>
[[nodiscard]] std::int64_t decode_matrix_header(Reader& reader, const DynamicField& field,
                                                std::size_t min_element_size,
                                                std::size_t object_size, Take take)
{
    const std::int32_t rank = reader.array_length(sizeof(std::uint32_t), sizeof(std::uint32_t));
    if (rank > 0 && rank != field.value_rank) {
        reader.fail(status::Bad_DecodingError);
    }
    if (rank < 0 || !reader.ok()) {
        return -1;
    }
    // An array's count has no more bits either (Part 6, 5.2.5).
    const std::size_t limit = std::min<std::uint32_t>(reader.limits().max_array_length, INT32_MAX);
    std::size_t count = rank == 0 ? 0 : 1;
    for (std::int32_t i = 0; i < rank; ++i) {
        const auto dimension = reader.number<std::uint32_t>();
        if (dimension > INT32_MAX) {
            reader.fail(status::Bad_DecodingError);
        }
        count = times_dimension(count, dimension, limit);
        take(dimension);
    }
    if (count > limit) {
        reader.fail(status::Bad_EncodingLimitsExceeded);
    } else if (min_element_size != 0 && count > reader.remaining() / min_element_size) {
        reader.fail(status::Bad_DecodingError);
    }
    const std::uint64_t cost = std::uint64_t{count} * object_size;
    return reader.charge(cost) && reader.ok() ? static_cast<std::int64_t>(count) : -1;
}

} // namespace busbar::binary::detail
