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

/// A range that includes both ends.
struct ImageRange {
    std::int64_t lower{0};
    std::int64_t upper{0};

    friend bool operator==(const ImageRange&, const ImageRange&) = default;
};

/// The type of a variable of a process image, or of a member of a structure: Boolean to Double,
/// String, DateTime, Guid, ByteString, XmlElement or StatusCode, or a structure, which is an
/// ExtensionObject; a scalar, or an array or matrix of fixed size. Enumerations are Int32.
struct ImageVariable {
    BuiltInType type{BuiltInType::Null};
    /// None for a scalar, one for an array, more for a matrix; none of them 0.
    std::vector<std::uint32_t> dimensions{};
    /// Maximum number of bytes of a text; ignored for other types.
    std::uint32_t capacity{0};
    /// The structure of an ExtensionObject; null for other types.
    std::shared_ptr<const ImageStructure> structure{};
    /// Clients cannot write it. Ignored for a member.
    bool is_read_only{false};
    /// The memory of a runtime in which the variable stays, with the layout of the image; empty:
    /// the variable is in the image's own memory. Ignored for a member.
    ///
    /// The layout is that of ImageStructure: numbers and elements one after another, texts as their
    /// length and room, aligned likewise. The image accesses it only within begin_scan() and
    /// publish(), on the task's thread, so that the runtime may use it there at any other time; it
    /// must exist as long as the task scans and no longer, and variables may share it. An invalid
    /// value in it, such as a text longer than its capacity, is null for readers; any BOOL except 0
    /// is true.
    std::span<std::byte> runtime{};
    /// The range of an integer or its elements: other values are not stored, whether written by
    /// clients or by store(); ignored for other types. The task itself is not restricted.
    std::optional<ImageRange> range{};
    /// Maximum number of UTF-16 units of a text, besides `capacity`; 0: any.
    std::uint32_t max_units{0};
};

namespace detail {

/// The header of a text in an image, followed by as many bytes as its capacity.
struct ImageText {
    static constexpr std::uint32_t null_size = UINT32_MAX;
    std::uint32_t size;
};

template <typename T>
inline constexpr bool is_image_text =
    std::same_as<T, String> || std::same_as<T, ByteString> || std::same_as<T, XmlElement>;

} // namespace detail

/// The types whose values have the same form in an image as in any other memory.
template <typename T>
concept ImageNumber = BuiltIn<T> && std::is_trivially_copyable_v<T> && !std::is_empty_v<T> &&
                      !detail::is_image_text<T> && sizeof(T) <= 16;

/// The place of a variable, or of a member within its structure. Arrays of numbers are in a
/// separate block of memory, because the server's side of the image keeps them as ready-made
/// Variants.
struct ImagePlace {
    BuiltInType type{BuiltInType::Null};
    bool in_arrays{false};
    bool is_read_only{false};
    /// The index among the arrays in the block of arrays.
    std::uint32_t array{0};
    /// Offset from the start of its block, or of the structure, in bytes.
    std::uint32_t offset{0};
    /// Distance from one element to the next, in bytes.
    std::uint32_t stride{0};
    std::uint32_t elements{1};
    std::uint32_t capacity{0};
    /// The same as in ImageVariable.
    std::uint32_t max_units{0};
    std::vector<std::uint32_t> dimensions{};
    std::shared_ptr<const ImageStructure> structure{};
    std::optional<ImageRange> range{}; // for integers
    /// Its address in a runtime's memory; null if it is in the image's own.
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
