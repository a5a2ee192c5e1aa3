#include "image_gather.hpp"

#include <algorithm>
#include <cstring>

#include <busbar/server/image_structure.hpp>

namespace busbar::server::detail {

namespace {

/// Returns whether some bytes are not a valid value.
bool can_be_wrong(const ImagePlace& place)
{
    if (place.is_structure()) {
        const auto members = place.structure->members();
        return std::any_of(members.begin(), members.end(), can_be_wrong);
    }
    return place.is_text() || place.type == BuiltInType::Boolean;
}

void repair_text(std::uint32_t capacity, std::byte* at)
{
    ImageText head{};
    std::memcpy(&head, at, sizeof head);
    if (head.size > capacity) {
        head.size = ImageText::null_size;
        std::memcpy(at, &head, sizeof head);
    }
}

} // namespace

void repair_booleans(std::byte* first, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        first[i] = std::byte{first[i] != std::byte{0}};
    }
}

void repair_value(const ImagePlace& place, std::byte* at)
{
    for (std::uint32_t i = 0; i < place.elements; ++i, at += place.stride) {
        if (place.is_structure()) {
            for (const ImagePlace& member : place.structure->members()) {
                repair_value(member, at + member.offset);
            }
        } else if (place.is_text()) {
            repair_text(place.capacity, at);
        } else if (place.type == BuiltInType::Boolean) {
            repair_booleans(at, 1);
        } else {
            return;
        }
    }
}

ImageGather::ImageGather(const ImageLayout& layout)
{
    for (const ImagePlace& place : layout.places()) {
        if (place.runtime != nullptr && !place.in_arrays) {
            add(place);
        }
    }
}

void ImageGather::add(const ImagePlace& place)
{
    if (!runs_.empty() && runs_.back().from + runs_.back().size == place.runtime &&
        runs_.back().to + runs_.back().size == place.offset) {
        runs_.back().size += place.bytes();
    } else {
        runs_.push_back({place.runtime, place.offset, place.bytes()});
    }
    if (place.type != BuiltInType::Boolean) {
        if (can_be_wrong(place)) {
            repaired_.push_back(&place);
        }
    } else if (!booleans_.empty() &&
               booleans_.back().first + booleans_.back().count == place.offset) {
        ++booleans_.back().count;
    } else {
        booleans_.push_back({place.offset, 1});
    }
}

void ImageGather::copy(std::byte* block) const
{
    for (const Run& run : runs_) {
        std::memcpy(block + run.to, run.from, run.size);
    }
    for (const Booleans& some : booleans_) {
        repair_booleans(block + some.first, some.count);
    }
    for (const ImagePlace* const place : repaired_) {
        repair_value(*place, block + place->offset);
    }
}

} // namespace busbar::server::detail
