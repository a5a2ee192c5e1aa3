#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server {

/// The variables of a process image and their places. Thread-compatible.
class BUSBAR_API ImageLayout {
public:
    static constexpr std::size_t max_bytes = std::size_t{256} << 20U;
    static constexpr std::size_t max_variables = 1'000'000;

    /// Adds a variable and returns its handle: 0, 1, 2... Bad_DataTypeIdUnknown for a type that an
    /// image cannot have, and for an ExtensionObject without structure; Bad_OutOfRange for a
    /// dimension of 0 or more than 16 dimensions, Bad_InvalidArgument for a runtime's memory whose
    /// size differs from the variable's or whose address is not aligned, Bad_OutOfMemory if the
    /// image would be larger than the constants above allow.
    [[nodiscard]] Result<std::uint32_t> add(const ImageVariable& variable);

    [[nodiscard]] std::size_t size() const { return places_.size(); }
    /// The place of a variable, by the handle that add() returned.
    [[nodiscard]] const ImagePlace& operator[](std::size_t handle) const { return places_[handle]; }
    [[nodiscard]] std::span<const ImagePlace> places() const { return places_; }
    /// The sizes of the blocks: of variables in the image, and of those that are gathered from a
    /// runtime's memory, both without arrays of numbers, and of arrays of numbers in the image.
    [[nodiscard]] std::size_t plain_bytes() const { return plain_bytes_; }
    [[nodiscard]] std::size_t gathered_bytes() const { return gathered_bytes_; }
    [[nodiscard]] std::size_t array_bytes() const { return array_bytes_; }
    /// Bytes of all variables, wherever they are.
    [[nodiscard]] std::size_t bytes() const
    {
        return plain_bytes_ + gathered_bytes_ + array_bytes_ + runtime_array_bytes_;
    }
    [[nodiscard]] std::size_t array_count() const { return array_count_; }

private:
    /// Returns the size of the block that contains the place.
    [[nodiscard]] std::size_t& block_of(const ImagePlace& place);

    std::vector<ImagePlace> places_;
    std::size_t plain_bytes_{0};
    std::size_t gathered_bytes_{0};
    std::size_t array_bytes_{0};
    /// Bytes of arrays of numbers in a runtime's memory.
    std::size_t runtime_array_bytes_{0};
    std::uint32_t array_count_{0};
};

} // namespace busbar::server
