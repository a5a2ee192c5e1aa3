#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/variant.hpp>

namespace busbar::server {

/// What a variable of a process image is: of Boolean to Double, String, DateTime, Guid,
/// ByteString, XmlElement or StatusCode; a scalar, or an array or matrix of fixed size.
struct ImageVariable {
    BuiltInType type{BuiltInType::Null};
    /// None for a scalar, one for an array, more for a matrix; none of them 0.
    std::vector<std::uint32_t> dimensions;
    /// The most bytes of a text; ignored for other types.
    std::uint32_t capacity{0};
};

namespace detail {

/// How a text lies in an image: this, followed by as many bytes as it may have.
struct ImageText {
    static constexpr std::uint32_t null_size = UINT32_MAX;
    std::uint32_t size;
};

template <typename T>
inline constexpr bool is_image_text =
    std::same_as<T, String> || std::same_as<T, ByteString> || std::same_as<T, XmlElement>;

} // namespace detail

/// The types whose values lie in an image as they lie in any other memory.
template <typename T>
concept ImageNumber = BuiltIn<T> && std::is_trivially_copyable_v<T> && !std::is_empty_v<T> &&
                      !detail::is_image_text<T> && sizeof(T) <= 16;

/// Where a variable lies. Arrays of anything but texts are in a block of memory of their own,
/// because the server's side of the image keeps them as ready-made Variants.
struct ImagePlace {
    BuiltInType type{BuiltInType::Null};
    bool in_arrays{false};
    /// The index among the arrays in the block of arrays.
    std::uint32_t array{0};
    /// From the start of its block, in bytes.
    std::uint32_t offset{0};
    /// From one element to the next, in bytes.
    std::uint32_t stride{0};
    std::uint32_t elements{1};
    std::uint32_t capacity{0};
    std::vector<std::uint32_t> dimensions;

    [[nodiscard]] bool is_array() const { return !dimensions.empty(); }
    [[nodiscard]] bool is_text() const
    {
        return type == BuiltInType::String || type == BuiltInType::ByteString ||
               type == BuiltInType::XmlElement;
    }
    [[nodiscard]] std::uint32_t bytes() const { return elements * stride; }
};

/// Which variables a process image has and where each of them lies. Thread-compatible.
class BUSBAR_API ImageLayout {
public:
    static constexpr std::size_t max_bytes = std::size_t{256} << 20U;
    static constexpr std::size_t max_variables = 1'000'000;

    /// Adds a variable and gives its handle: 0, 1, 2... Bad_DataTypeIdUnknown for a type that an
    /// image cannot have, Bad_OutOfRange for a dimension of 0 or more than 16 dimensions,
    /// Bad_OutOfMemory if the image would be larger than the constants above allow.
    [[nodiscard]] Result<std::uint32_t> add(const ImageVariable& variable);

    [[nodiscard]] std::size_t size() const { return places_.size(); }
    [[nodiscard]] const ImagePlace& operator[](std::size_t handle) const { return places_[handle]; }
    [[nodiscard]] std::span<const ImagePlace> places() const { return places_; }
    /// The sizes of the blocks.
    [[nodiscard]] std::size_t plain_bytes() const { return plain_bytes_; }
    [[nodiscard]] std::size_t array_bytes() const { return array_bytes_; }
    [[nodiscard]] std::size_t array_count() const { return array_count_; }

private:
    std::vector<ImagePlace> places_;
    std::size_t plain_bytes_{0};
    std::size_t array_bytes_{0};
    std::uint32_t array_count_{0};
};

} // namespace busbar::server
