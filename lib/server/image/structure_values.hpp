#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <busbar/core/variant.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server::detail {

/// The structures of one scan that were read, in their encoding: each variable once, however often
/// it is read, with the bodies in a few blocks of memory. One thread.
class StructureValues {
public:
    static constexpr std::size_t usual_block = 16U << 10U;

    /// Maximum memory for one variable, in addition to a usual_block for all of them; 0 if it is
    /// not a structure.
    [[nodiscard]] static std::uint64_t max_bytes(const ImagePlace& place);

    /// Returns the value of the variable `handle` at `from`; null if one of its texts is not UTF-8.
    /// Valid until recycle().
    [[nodiscard]] const Variant& value(std::uint32_t handle, const ImagePlace& place,
                                       const std::byte* from);
    /// Frees most of the memory, since no value is used any more.
    void recycle();

private:
    struct Block {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size;
        std::size_t used;
    };

    [[nodiscard]] Variant make(const ImagePlace& place, const std::byte* from);
    /// Returns a block with at least `room` bytes; unused ones are available again.
    [[nodiscard]] Block& block_with(std::size_t room);

    std::unordered_map<std::uint32_t, Variant> values_;
    std::vector<Block> blocks_;
};

} // namespace busbar::server::detail
