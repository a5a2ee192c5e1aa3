#include "image_copy.hpp"

#include <cstring>

#include "image_gather.hpp"
#include "image_types.hpp"

namespace busbar::server::detail {

namespace {

/// Returns an array of zeros for the place, and the address of its elements.
template <typename T>
Variant make_array(const ImagePlace& place, std::byte*& elements)
{
    Variant array = Variant::matrix(Array<T>(std::size_t{place.elements}),
                                    Array<std::uint32_t>{place.dimensions});
    elements = std::as_writable_bytes(array.array_if<T>()->span()).data();
    return array;
}

} // namespace

ImageCopy::ImageCopy(const ImageLayout& layout)
    : plain_{std::make_unique<std::byte[]>(layout.plain_bytes())},
      plain_bytes_{layout.plain_bytes()}, gathered_{std::make_unique<std::byte[]>(
                                              layout.gathered_bytes())},
      gathered_bytes_{layout.gathered_bytes()}
{
    arrays_.reserve(layout.array_count());
    copies_.reserve(layout.array_count());
    for (const ImagePlace& place : layout.places()) {
        if (!place.in_arrays) {
            continue;
        }
        std::byte* to = nullptr;
        arrays_.push_back(visit_image_type(
            place.type,
            [&](auto tag) {
                using T = typename decltype(tag)::type;
                if constexpr (is_image_text<T>) {
                    return Variant{};
                } else {
                    return make_array<T>(place, to);
                }
            },
            [] { return Variant{}; }));
        const bool is_repaired = place.runtime != nullptr && place.type == BuiltInType::Boolean;
        copies_.push_back({&place, to, is_repaired});
    }
}

void ImageCopy::fill(const ImageMemory& memory)
{
    if (plain_bytes_ != 0) {
        std::memcpy(plain_.get(), memory.plain(), plain_bytes_);
    }
    memory.gather(gathered_.get());
    for (std::size_t i = 0; i < copies_.size(); ++i) {
        fill_array(i, memory);
    }
}

void ImageCopy::fill_array(std::size_t array, const ImageMemory& memory)
{
    const ArrayCopy& copy = copies_[array];
    std::memcpy(copy.to, memory.bytes(*copy.from), copy.from->bytes());
    if (copy.is_repaired) {
        repair_booleans(copy.to, copy.from->bytes());
    }
}

const std::byte* ImageCopy::bytes(const ImagePlace& place) const
{
    return place.in_arrays ? number_bytes(array(place)).data() : plain(place);
}

} // namespace busbar::server::detail
