#include <busbar/server/image_structure.hpp>

#include <algorithm>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/server/image_layout.hpp>

#include "image_shape.hpp"
#include "image_types.hpp"

namespace busbar::server {

namespace {

/// Returns the maximum number of bytes of one element on the wire (Part 6, 5.2.2).
std::uint64_t wire_size_of_one(const ImagePlace& place)
{
    if (place.is_structure()) {
        return place.structure->max_wire_size();
    }
    return place.is_text() ? sizeof(std::int32_t) + place.capacity : place.stride;
}

std::uint64_t wire_size(const ImagePlace& place)
{
    // The length of an array, or the number of dimensions of a matrix and the dimensions (Part 6,
    // 5.2.5).
    const std::size_t rank = place.dimensions.size();
    const std::size_t numbers = rank > 1 ? rank + 1 : rank;
    return numbers * sizeof(std::int32_t) + place.elements * wire_size_of_one(place);
}

} // namespace

Result<std::shared_ptr<const ImageStructure>>
ImageStructure::create(NodeId encoding_id, std::span<const ImageVariable> members)
{
    if (members.empty() || members.size() > max_members) {
        return fail(status::Bad_OutOfRange);
    }
    auto made = std::make_shared<ImageStructure>(Key{});
    made->encoding_id_ = std::move(encoding_id);
    made->members_.reserve(members.size());
    for (const ImageVariable& member : members) {
        if (const StatusCode added = made->add(member); !added.is_good()) {
            return fail(added);
        }
    }
    made->size_ = static_cast<std::uint32_t>(detail::round_up(made->size_, made->alignment_));
    return std::shared_ptr<const ImageStructure>{std::move(made)};
}

StatusCode ImageStructure::add(const ImageVariable& member)
{
    constexpr std::size_t most_alignment = 8;
    const std::size_t room = ImageLayout::max_bytes - size_;
    auto place = detail::shape_of(member, room - std::min(room, 2 * most_alignment));
    if (!place) {
        return place.error();
    }
    if (place->is_structure()) {
        depth_ = std::max(depth_, place->structure->depth_ + 1);
        has_texts_ |= place->structure->has_texts_;
    }
    max_wire_size_ += wire_size(*place);
    if (depth_ > max_depth || max_wire_size_ > INT32_MAX) {
        return status::Bad_OutOfRange;
    }
    has_texts_ |= place->is_text();
    const std::uint32_t unit = detail::alignment_of(*place);
    alignment_ = std::max(alignment_, unit);
    place->offset = static_cast<std::uint32_t>(detail::round_up(size_, unit));
    size_ = place->offset + place->bytes();
    members_.push_back(std::move(*place));
    return status::Good;
}

} // namespace busbar::server
