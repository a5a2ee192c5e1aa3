#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <busbar/core/variant.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::server::detail {

/// The structures of one scan that somebody has read, as they go over the wire: each variable once,
/// however often it is asked for, the bodies in a few blocks of memory. One thread.
class StructureValues {
public:
    static constexpr std::size_t usual_block = 16U << 10U;

    /// What it holds of one variable at most, besides a usual_block for all of them; 0 if that is
    /// no structure.
    [[nodiscard]] static std::uint64_t max_bytes(const ImagePlace& place);

    /// The value of the variable `handle`, which lies at `from`. Valid until recycle().
    [[nodiscard]] const Variant& value(std::uint32_t handle, const ImagePlace& place,
                                       const std::byte* from);
    /// Nothing that was given is used any more: most of the memory is let go.
    void recycle();

private:
    struct Block {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size;
        std::size_t used;
    };

    [[nodiscard]] Variant make(const ImagePlace& place, const std::byte* from);
    /// At least so many bytes of a block; what is not used is to be had again.
    [[nodiscard]] Block& block_with(std::size_t room);

    std::unordered_map<std::uint32_t, Variant> values_;
    std::vector<Block> blocks_;
};

} // namespace busbar::server::detail
