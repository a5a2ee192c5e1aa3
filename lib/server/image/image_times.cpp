#include "image_times.hpp"

#include <algorithm>
#include <cstring>

namespace busbar::server::detail {

namespace {

/// The bytes that are compared at once.
constexpr std::size_t part_size = 1'024;
constexpr std::size_t word_size = sizeof(std::uint64_t);
constexpr std::size_t line_size = 64;
static_assert(part_size % line_size == 0);

template <std::size_t size>
bool differ(const std::byte* a, const std::byte* b)
{
    return std::memcmp(a, b, size) != 0;
}

bool differ(const std::byte* a, const std::byte* b, std::size_t size)
{
    switch (size) { // known sizes need no function call
    case 1:
        return differ<1>(a, b);
    case 2:
        return differ<2>(a, b);
    case 4:
        return differ<4>(a, b);
    case word_size:
        return differ<word_size>(a, b);
    default:
        return std::memcmp(a, b, size) != 0;
    }
}

/// Without a branch, so that a compiler uses vectors for it.
bool lines_differ(const std::byte* a, const std::byte* b)
{
    std::uint64_t found = 0;
    for (std::size_t at = 0; at < line_size; at += word_size) {
        std::uint64_t of_a = 0;
        std::uint64_t of_b = 0;
        std::memcpy(&of_a, a + at, word_size);
        std::memcpy(&of_b, b + at, word_size);
        found |= of_a ^ of_b;
    }
    return found != 0;
}

} // namespace

void ImageTimes::Block::add(const ImagePlace& place, std::uint32_t index)
{
    const std::uint32_t end = place.offset + place.bytes();
    while (first.size() * word_size < end) {
        // The word begins in this variable, or in the gap before it.
        first.push_back(static_cast<std::uint32_t>(spans.size()));
    }
    spans.push_back({place.offset, place.bytes(), index});
}

void ImageTimes::Block::finish(std::size_t size)
{
    changed.resize((size + part_size - 1) / part_size);
}

ImageTimes::ImageTimes(const ImageLayout& layout)
    : count_{layout.size()}, stamps_{std::make_unique<Stamp[]>(layout.size())}
{
    for (std::uint32_t i = 0; i < layout.size(); ++i) {
        const ImagePlace& place = layout[i];
        if (place.in_arrays) {
            arrays_.push_back({i});
        } else {
            (place.runtime != nullptr ? gathered_ : plain_).add(place, i);
        }
    }
    plain_.finish(layout.plain_bytes());
    gathered_.finish(layout.gathered_bytes());
}

void ImageTimes::fill(const ImageMemory& memory, const Scan& scan)
{
    if (scan.before == nullptr) {
        return fill_all(memory, scan);
    }
    fill_plain(memory, scan);
    fill_gathered(memory, scan);
    fill_arrays(memory, scan);
}

void ImageTimes::fill_all(const ImageMemory& memory, const Scan& scan)
{
    scan.to.fill(memory);
    std::fill(plain_.changed.begin(), plain_.changed.end(), scan.number);
    for (Array& array : arrays_) {
        array.changed = scan.number;
    }
    for (Stamp& stamp : std::span{stamps_.get(), count_}) {
        stamp.before.store(scan.time.ticks, std::memory_order_relaxed);
        stamp.last.store(scan.time.ticks, std::memory_order_relaxed);
    }
}

void ImageTimes::fill_plain(const ImageMemory& memory, const Scan& scan)
{
    const std::byte* const before = scan.before->plain_.get();
    const std::byte* const now = memory.plain();
    std::byte* const to = scan.to.plain_.get();
    const std::size_t bytes = scan.to.plain_bytes_;
    for (std::size_t part = 0; part < plain_.changed.size(); ++part) {
        const std::size_t begin = part * part_size;
        const std::size_t size = std::min(part_size, bytes - begin);
        if (std::memcmp(before + begin, now + begin, size) != 0) {
            plain_.changed[part] = scan.number;
            note_part(plain_, before, now, begin, size, scan.time);
        }
        if (plain_.changed[part] > scan.filled) {
            std::memcpy(to + begin, now + begin, size);
        }
    }
}

void ImageTimes::fill_gathered(const ImageMemory& memory, const Scan& scan)
{
    const std::byte* const before = scan.before->gathered_.get();
    std::byte* const now = scan.to.gathered_.get();
    const std::size_t bytes = scan.to.gathered_bytes_;
    memory.gather(now);
    for (std::size_t part = 0; part < gathered_.changed.size(); ++part) {
        const std::size_t begin = part * part_size;
        const std::size_t size = std::min(part_size, bytes - begin);
        if (std::memcmp(before + begin, now + begin, size) != 0) {
            note_part(gathered_, before, now, begin, size, scan.time);
        }
    }
}

void ImageTimes::fill_arrays(const ImageMemory& memory, const Scan& scan)
{
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
        const ImageCopy::ArrayCopy& to = scan.to.copies_[i];
        const std::size_t size = to.from->bytes();
        // Booleans of a runtime are compared when they are repaired.
        const std::byte* const now = to.is_repaired ? to.to : memory.bytes(*to.from);
        if (to.is_repaired) {
            scan.to.fill_array(i, memory);
        }
        if (std::memcmp(scan.before->copies_[i].to, now, size) != 0) {
            arrays_[i].changed = scan.number;
            stamp(arrays_[i].index, scan.time);
        }
        if (!to.is_repaired && arrays_[i].changed > scan.filled) {
            std::memcpy(to.to, now, size);
        }
    }
}

void ImageTimes::note_part(const Block& block, const std::byte* before, const std::byte* now,
                           std::size_t begin, std::size_t size, DateTime time)
{
    const std::size_t end = begin + size;
    std::size_t next = 0; // the first variable that was not compared
    for (std::size_t at = begin; at < end; at += word_size) {
        if (at % line_size == 0 && end - at >= line_size && !lines_differ(before + at, now + at)) {
            at += line_size - word_size;
            continue;
        }
        const std::size_t word_end = std::min(at + word_size, end);
        const bool is_same = word_end - at == word_size
                                 ? !differ<word_size>(before + at, now + at)
                                 : std::memcmp(before + at, now + at, word_end - at) == 0;
        if (is_same) {
            continue;
        }
        next = std::max<std::size_t>(next, block.first[at / word_size]);
        for (; next < block.spans.size() && block.spans[next].offset < word_end; ++next) {
            const Span& span = block.spans[next];
            if (differ(before + span.offset, now + span.offset, span.size)) {
                stamp(span.index, time);
            }
        }
    }
}

void ImageTimes::stamp(std::uint32_t index, DateTime time)
{
    Stamp& stamp = stamps_[index];
    const std::int64_t last = stamp.last.load(std::memory_order_relaxed);
    if (last == time.ticks) { // a variable in two parts
        return;
    }
    stamp.before.store(last, std::memory_order_relaxed);
    // release: a reader that sees it sees `before`, too.
    stamp.last.store(time.ticks, std::memory_order_release);
}

} // namespace busbar::server::detail
