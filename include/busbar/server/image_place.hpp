#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <busbar/core/variant.hpp>

namespace busbar::server {

class ImageStructure;

/// Both ends belong to it.
struct ImageRange {
    std::int64_t lower{0};
    std::int64_t upper{0};

    friend bool operator==(const ImageRange&, const ImageRange&) = default;
};

/// What a variable of a process image is, or a member of a structure: of Boolean to Double, String,
/// DateTime, Guid, ByteString, XmlElement or StatusCode, or a structure, which is an
/// ExtensionObject; a scalar, or an array or matrix of fixed size. Enumerations are Int32.
struct ImageVariable {
    BuiltInType type{BuiltInType::Null};
    /// None for a scalar, one for an array, more for a matrix; none of them 0.
    std::vector<std::uint32_t> dimensions{};
    /// The most bytes of a text; ignored for other types.
    std::uint32_t capacity{0};
    /// Of an ExtensionObject; null for other types.
    std::shared_ptr<const ImageStructure> structure{};
    /// Clients cannot write it. Means nothing for a member.
    bool is_read_only{false};
    /// The memory of a runtime in which the variable stays, laid out as the image would; none: it
    /// lies in the image's own. Means nothing for a member.
    ///
    /// As ImageStructure says it: numbers and elements one behind another, texts as their length
    /// and room. Aligned as that. The image touches it within begin_scan() and publish() only, in
    /// the task's thread, so that the runtime may use it there at any other time; it must be there
    /// as long as the task scans and no longer, and variables may share it. What is no value in it,
    /// as a text longer than it may be, is null in what readers see, any BOOL but 0 is true.
    std::span<std::byte> runtime{};
    /// Of an integer or its elements: no other value is stored, whoever writes it; ignored for
    /// other types. The task itself is not hindered.
    std::optional<ImageRange> range{};
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

/// Where a variable lies, or a member within its structure. Arrays of numbers are in a block of
/// memory of their own, because the server's side of the image keeps them as ready-made Variants.
struct ImagePlace {
    BuiltInType type{BuiltInType::Null};
    bool in_arrays{false};
    bool is_read_only{false};
    /// The index among the arrays in the block of arrays.
    std::uint32_t array{0};
    /// From the start of its block, or of the structure, in bytes.
    std::uint32_t offset{0};
    /// From one element to the next, in bytes.
    std::uint32_t stride{0};
    std::uint32_t elements{1};
    std::uint32_t capacity{0};
    std::vector<std::uint32_t> dimensions{};
    std::shared_ptr<const ImageStructure> structure{};
    std::optional<ImageRange> range{}; // of integers
    /// Where it stays in a runtime's memory; null if it lies in the image's own.
    std::byte* runtime{nullptr};

    [[nodiscard]] bool is_array() const { return !dimensions.empty(); }
    [[nodiscard]] bool is_text() const
    {
        return type == BuiltInType::String || type == BuiltInType::ByteString ||
               type == BuiltInType::XmlElement;
    }
    [[nodiscard]] bool is_structure() const { return structure != nullptr; }
    [[nodiscard]] std::uint32_t bytes() const { return elements * stride; }
};

} // namespace busbar::server
