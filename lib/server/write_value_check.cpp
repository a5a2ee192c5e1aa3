#include "write_value_check.hpp"

#include <busbar/core/status_codes.hpp>

namespace busbar::server::detail {

namespace {

constexpr std::int32_t scalar_or_one_dimension = -3;
constexpr std::int32_t any_rank = -2;
constexpr std::int32_t scalar = -1;
constexpr std::int32_t one_or_more_dimensions = 0;

bool has(std::uint32_t types, BuiltInType type)
{
    return ((types >> static_cast<unsigned>(type)) & 1U) != 0;
}

std::int32_t dimension_count(const Variant& value)
{
    if (value.is_matrix()) {
        return static_cast<std::int32_t>(value.dimensions().size());
    }
    return value.is_array() ? 1 : 0;
}

bool fits_rank(std::int32_t dimensions, std::int32_t rank)
{
    switch (rank) {
    case any_rank:
        return true;
    case scalar_or_one_dimension:
        return dimensions <= 1;
    case scalar:
        return dimensions == 0;
    case one_or_more_dimensions:
        return dimensions >= 1;
    default:
        return dimensions == rank;
    }
}

bool fits_dimensions(const Variant& value, std::span<const std::uint32_t> limits)
{
    if (value.is_matrix()) {
        const auto dimensions = value.dimensions();
        if (dimensions.size() != limits.size()) {
            return limits.empty();
        }
        for (std::size_t i = 0; i < limits.size(); ++i) {
            if (limits[i] != 0 && dimensions[i] > limits[i]) {
                return false;
            }
        }
        return true;
    }
    return !value.is_array() || limits.size() != 1 || limits[0] == 0 ||
           value.array_size() <= limits[0];
}

} // namespace

StatusCode check_element_type(const Variant& value, const ValueShape& shape)
{
    return has(shape.types, value.type()) ? status::Good : status::Bad_TypeMismatch;
}

StatusCode check_shape(const Variant& value, const ValueShape& shape)
{
    if (value.is_null()) {
        // Only a BaseDataType has a value that is null.
        return check_element_type(value, shape);
    }
    const bool fits = check_element_type(value, shape).is_good() &&
                      fits_rank(dimension_count(value), shape.rank) &&
                      fits_dimensions(value, shape.dimensions);
    return fits ? status::Good : status::Bad_TypeMismatch;
}

bool is_byte_string_for_array(const Variant& value, const ValueShape& shape)
{
    return value.is_scalar() && value.type() == BuiltInType::ByteString &&
           !has(shape.types, BuiltInType::ByteString) && has(shape.types, BuiltInType::Byte) &&
           fits_rank(1, shape.rank);
}

Variant to_byte_array(const ByteString& bytes)
{
    if (bytes.is_null()) {
        return Variant{Array<std::uint8_t>{}};
    }
    const auto from = bytes.span();
    const auto* first = reinterpret_cast<const std::uint8_t*>(from.data());
    return Variant{Array<std::uint8_t>{std::span{first, from.size()}}};
}

} // namespace busbar::server::detail
