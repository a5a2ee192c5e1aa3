#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/server/image_layout.hpp>

namespace busbar::server::detail {

/// Copies the variables of a layout that stay in a runtime's memory into a scan, except arrays of
/// numbers: neighbours in both places are copied at once.
///
/// The layout must outlive it. Never allocates after construction.
class ImageGather {
public:
    explicit ImageGather(const ImageLayout& layout);

    /// Copies to a block of ImageLayout::gathered_bytes(). Called by the task, since it reads the
    /// runtime's memory.
    void copy(std::byte* block) const;

private:
    struct Run {
        const std::byte* from;
        std::uint32_t to;
        std::uint32_t size;
    };
    /// Booleans in the block.
    struct Booleans {
        std::uint32_t first;
        std::uint32_t count;
    };

    void add(const ImagePlace& place);

    std::vector<Run> runs_;
    std::vector<Booleans> booleans_;
    std::vector<const ImagePlace*> repaired_;
};

/// Turns the bytes of a runtime's Booleans into valid ones: all except 0 become 1.
void repair_booleans(std::byte* first, std::size_t count);

/// Makes the value at `at` valid, wherever it came from: no text is longer than its place.
void repair_value(const ImagePlace& place, std::byte* at);

} // namespace busbar::server::detail
