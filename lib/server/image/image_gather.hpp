#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/server/image_layout.hpp>

namespace busbar::server::detail {

/// How the variables of a layout that stay in a runtime's memory get into a scan, arrays of numbers
/// apart: what lies side by side there and in the block is copied at once.
///
/// The layout must outlive it. Never allocates after it was made.
class ImageGather {
public:
    explicit ImageGather(const ImageLayout& layout);

    /// To a block of ImageLayout::gathered_bytes(). The task, since it reads the runtime's memory.
    void copy(std::byte* block) const;

private:
    struct Run {
        const std::byte* from;
        std::uint32_t to;
        std::uint32_t size;
    };
    /// Truth values in the block.
    struct Booleans {
        std::uint32_t first;
        std::uint32_t count;
    };

    void add(const ImagePlace& place);

    std::vector<Run> runs_;
    std::vector<Booleans> booleans_;
    std::vector<const ImagePlace*> repaired_;
};

/// Makes values of so many bytes of which a runtime may have had another idea: all but 0 is 1.
void repair_booleans(std::byte* first, std::size_t count);

/// Makes a value of what lies at `at`, wherever it came from: no text is longer than its place.
void repair_value(const ImagePlace& place, std::byte* at);

} // namespace busbar::server::detail
