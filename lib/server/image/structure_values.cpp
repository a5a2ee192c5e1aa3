#include "structure_values.hpp"

#include <algorithm>

#include <busbar/core/extension_object.hpp>
#include <busbar/server/image_structure.hpp>

#include "structure_codec.hpp"

namespace busbar::server::detail {

std::uint64_t StructureValues::max_bytes(const ImagePlace& place)
{
    // Memory for a value, and for a block, in their growing lists.
    constexpr std::uint64_t of_value = 256;
    constexpr std::uint64_t of_block = 4 * sizeof(Block);
    if (!place.is_structure()) {
        return 0;
    }
    // A block ends if the next value might not fit: it wastes less than the size of a value.
    const std::uint64_t of_element =
        2 * place.structure->max_wire_size() + sizeof(ExtensionObject) + of_block;
    return of_value + place.elements * of_element;
}

const Variant& StructureValues::value(std::uint32_t handle, const ImagePlace& place,
                                      const std::byte* from)
{
    const auto found = values_.find(handle);
    return found != values_.end() ? found->second
                                  : values_.emplace(handle, make(place, from)).first->second;
}

Variant StructureValues::make(const ImagePlace& place, const std::byte* from)
{
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        if (!has_valid_texts(*place.structure, from + std::size_t{i} * place.stride)) {
            return {};
        }
    }
    const auto most = static_cast<std::size_t>(place.structure->max_wire_size());
    const auto encode_next = [&] {
        Block& block = block_with(most);
        const std::span<std::byte> room{block.bytes.get() + block.used, most};
        const std::size_t size = encode_structure(*place.structure, from, room);
        block.used += size;
        from += place.stride;
        return borrow_object(*place.structure, room.first(size));
    };
    if (!place.is_array()) {
        return Variant{encode_next()};
    }
    Array<ExtensionObject> values;
    values.reserve(place.elements);
    for (std::uint32_t i = 0; i < place.elements; ++i) {
        values.push_back(encode_next());
    }
    return Variant::matrix(std::move(values), Array<std::uint32_t>{place.dimensions});
}

StructureValues::Block& StructureValues::block_with(std::size_t room)
{
    if (blocks_.empty() || blocks_.back().size - blocks_.back().used < room) {
        const std::size_t size = std::max(room, usual_block);
        blocks_.push_back({std::unique_ptr<std::byte[]>{new std::byte[size]}, size, 0});
    }
    return blocks_.back();
}

void StructureValues::recycle()
{
    values_.clear();
    if (blocks_.size() == 1 && blocks_.front().size == usual_block) {
        blocks_.front().used = 0;
    } else {
        blocks_.clear();
    }
}

} // namespace busbar::server::detail
