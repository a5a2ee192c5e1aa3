#pragma once

#include <cstdint>
#include <span>

#include <busbar/core/status_code.hpp>
#include <busbar/core/variant.hpp>

namespace busbar::server::detail {

/// What a Variable's DataType, ValueRank and ArrayDimensions let its value be.
struct ValueShape {
    /// The built-in types that may encode the DataType, as bits by their ids: one for most, several
    /// for an abstract one, all and that of no value for BaseDataType.
    std::uint32_t types{~0U};
    /// Part 3, 5.6.2: -3 scalar or one dimension, -2 anything, -1 scalar, 0 one or more
    /// dimensions, else the number of dimensions.
    std::int32_t rank{-2};
    /// The most elements of each dimension; 0 is no limit.
    std::span<const std::uint32_t> dimensions;
};

/// Good, or Bad_TypeMismatch if `value` is not of that type and shape (Part 4, 5.11.4.2).
[[nodiscard]] StatusCode check_shape(const Variant& value, const ValueShape& shape);

/// As check_shape for a value that replaces a part of the Variable's: its elements only.
[[nodiscard]] StatusCode check_element_type(const Variant& value, const ValueShape& shape);

/// True if `value` is a ByteString where an array of Byte is expected, which a server has to
/// accept (Part 4, 5.11.4.2).
[[nodiscard]] bool is_byte_string_for_array(const Variant& value, const ValueShape& shape);
[[nodiscard]] Variant to_byte_array(const ByteString& bytes);

} // namespace busbar::server::detail
