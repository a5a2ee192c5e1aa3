#pragma once

#include <busbar/binary/codec.hpp>

namespace busbar {

/// A structure's field of two or more dimensions (Part 6, 5.2.5, inline matrix).
///
/// The values are in row-major order, and their number is the product of the dimensions, 0 if one
/// of them is 0. A default-constructed Matrix is null.
template <typename T>
struct Matrix {
    Array<std::int32_t> dimensions;
    Array<T> values;

    friend bool operator==(const Matrix&, const Matrix&) = default;
};

namespace detail {

/// The product of `dimensions`, 0 if one is not positive, or `limit` + 1 past the limit.
[[nodiscard]] inline std::size_t matrix_size(const Array<std::int32_t>& dimensions,
                                             std::size_t limit)
{
    std::size_t product = dimensions.empty() ? 0 : 1;
    for (const std::int32_t dimension : dimensions) {
        if (dimension <= 0) {
            return 0;
        }
        const auto size = static_cast<std::size_t>(dimension);
        product = product > limit / size ? limit + 1 : product * size;
    }
    return product;
}

} // namespace detail

/// Fails with Bad_EncodingError if the dimensions and the number of values disagree.
template <typename T>
void encode(binary::Writer& writer, const Matrix<T>& matrix)
{
    const std::size_t count = detail::matrix_size(matrix.dimensions, INT32_MAX);
    if (matrix.dimensions.size() == 1 || count != matrix.values.size()) {
        writer.fail(status::Bad_EncodingError);
        return;
    }
    encode(writer, matrix.dimensions);
    for (const T& value : matrix.values) {
        encode(writer, value);
    }
}

/// Reads a matrix; the reader fails if it is larger than its limits or the message.
template <typename T>
void decode(binary::Reader& reader, Matrix<T>& matrix)
{
    matrix.values.reset();
    decode(reader, matrix.dimensions);
    const std::size_t count =
        detail::matrix_size(matrix.dimensions, reader.limits().max_array_length);
    const std::size_t least = detail::min_wire_size<T>();
    if (matrix.dimensions.size() == 1) {
        reader.fail(status::Bad_DecodingError); // "at least 2"
    } else if (count > reader.limits().max_array_length) {
        reader.fail(status::Bad_EncodingLimitsExceeded);
    } else if (least != 0 && count > reader.remaining() / least) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok() || matrix.dimensions.empty() || !reader.charge(count * sizeof(T))) {
        return;
    }
    matrix.values.resize(count);
    for (T& value : matrix.values) {
        decode(reader, value);
    }
}

} // namespace busbar
