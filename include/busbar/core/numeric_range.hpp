#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// NumericRange (Part 4, 7.27): "3", "1:4", "0:1,2:5". An empty text is not a range.
class BUSBAR_API NumericRange {
public:
    static constexpr std::size_t max_dimensions = 16;
    /// The first and the last index of a dimension, both included.
    struct Bounds {
        std::uint32_t first{0};
        std::uint32_t last{0};

        /// The number of elements, up to 2^32.
        [[nodiscard]] std::uint64_t count() const { return std::uint64_t{last} - first + 1; }
        friend bool operator==(const Bounds&, const Bounds&) = default;
    };

    NumericRange() = default;
    /// Returns Bad_IndexRangeInvalid for anything that Part 4, 7.27 does not allow, and for too
    /// many dimensions.
    [[nodiscard]] static Result<NumericRange> parse(std::string_view text);

    [[nodiscard]] bool empty() const { return count_ == 0; }
    [[nodiscard]] std::span<const Bounds> bounds() const { return {bounds_.data(), count_}; }

    friend bool operator==(const NumericRange&, const NumericRange&) = default;

private:
    std::array<Bounds, max_dimensions> bounds_{};
    std::size_t count_{0};
};

/// Returns the part of `value` that `range` selects. The value is an array, a matrix, a String, a
/// ByteString or, with one dimension more in the range, an array of these two. The last bound may
/// lie past the end, the first may not. Bad_IndexRangeNoData if nothing is there or the dimensions
/// do not fit.
[[nodiscard]] BUSBAR_API Result<Variant> read_range(const Variant& value,
                                                    const NumericRange& range);

/// Replaces the part of `target` that `range` selects with `part`, which must have the same type
/// and the size of the range. Bad_IndexRangeNoData if any of the range lies outside `target`,
/// Bad_IndexRangeDataMismatch if the sizes differ, Bad_TypeMismatch if the types do; `target` is
/// then unchanged (Part 4, 5.11.4.4).
[[nodiscard]] BUSBAR_API Result<void> write_range(Variant& target, const NumericRange& range,
                                                  const Variant& part);

} // namespace busbar
