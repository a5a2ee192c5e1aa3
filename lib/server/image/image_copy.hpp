#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <busbar/server/image_memory.hpp>

namespace busbar::server::detail {

/// The variables of one layout as readers see them: scalars, texts and structures as bytes, arrays
/// of numbers as Variants.
class ImageCopy {
public:
    explicit ImageCopy(const ImageLayout& layout);

    /// Copies everything.
    void fill(const ImageMemory& memory);

    [[nodiscard]] const std::byte* plain(const ImagePlace& place) const
    {
        return (place.runtime != nullptr ? gathered_ : plain_).get() + place.offset;
    }
    [[nodiscard]] const Variant& array(const ImagePlace& place) const
    {
        return arrays_[place.array];
    }
    /// Returns a variable's bytes, as in ImageMemory.
    [[nodiscard]] const std::byte* bytes(const ImagePlace& place) const;

private:
    friend class ImageTimes;

    struct ArrayCopy {
        const ImagePlace* from;
        std::byte* to;
        /// Booleans of a runtime may be any bytes.
        bool is_repaired;
    };

    void fill_array(std::size_t array, const ImageMemory& memory);

    std::unique_ptr<std::byte[]> plain_;
    std::size_t plain_bytes_;
    std::unique_ptr<std::byte[]> gathered_;
    std::size_t gathered_bytes_;
    std::vector<Variant> arrays_;
    std::vector<ArrayCopy> copies_;
};

} // namespace busbar::server::detail
