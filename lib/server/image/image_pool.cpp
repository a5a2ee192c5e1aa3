#include "image_pool.hpp"

namespace busbar::server::detail {

void ImageBuffer::fill(const ImageMemory& memory, const ImageSegments& segments, DateTime time,
                       std::uint64_t scan)
{
    copy_.fill(memory);
    segments_ = segments.count();
    for (std::uint32_t i = 0; i < segments_; ++i) {
        segments[i].copies[index_].fill(segments[i].memory);
    }
    time_ = time;
    scan_ = scan;
}

ImagePool::ImagePool(const ImageLayout& layout, std::uint32_t max_pins, std::uint32_t max_queued)
    : max_pins_{max_pins}, queue_(max_queued)
{
    for (std::uint32_t i = 0; i < max_pins + max_queued + 3; ++i) {
        buffers_.push_back(std::make_unique<ImageBuffer>(layout, i));
    }
}

std::uint64_t ImagePool::find_free() const
{
    // Longest unused first, which is the most likely to be free.
    for (std::size_t i = 1; i <= buffers_.size(); ++i) {
        const std::uint64_t index = (current_ + i) % buffers_.size();
        const ImageBuffer& candidate = at(index);
        // acquire: with the release of the last unpin() all reads of the buffer are behind us, and
        // it may be overwritten.
        if (index != current_ &&
            candidate.released_.load(std::memory_order_acquire) == candidate.taken_) {
            return index;
        }
    }
    return no_buffer;
}

bool ImagePool::publish(const ImageMemory& memory, const ImageSegments& segments, DateTime time)
{
    const std::uint64_t next = find_free();
    if (next == no_buffer) {
        return false; // the class comment says why this does not happen
    }
    at(next).fill(memory, segments, time, ++scans_);
    const std::uint64_t end = queue_end_.load(std::memory_order_relaxed);
    // acquire: the follower has given back what it took out before.
    const bool is_queued = is_followed_.load(std::memory_order_acquire) &&
                           end - queue_begin_.load(std::memory_order_acquire) < queue_.size();
    // release: who pins `next` sees what was just filled in. acquire: who took a pin of the old
    // buffer was admitted after others had given theirs back (see pin); find_free must see that
    // those are back, else it could count more than max_pins.
    const std::uint64_t old =
        latest_.exchange(next << index_shift | (is_queued ? 1U : 0U), std::memory_order_acq_rel);
    if (current_ != no_buffer) {
        constexpr std::uint64_t count_mask = (std::uint64_t{1} << index_shift) - 1;
        at(current_).taken_ += old & count_mask;
    }
    current_ = next;
    if (is_queued) {
        queued(end) = next;
        queue_end_.store(end + 1, std::memory_order_release);
    }
    return is_queued;
}

void ImagePool::follow(bool follows)
{
    is_followed_.store(false, std::memory_order_release);
    while (ImageBuffer* const next = next_queued()) {
        unpin(*next);
    }
    is_followed_.store(follows, std::memory_order_release);
}

ImageBuffer* ImagePool::next_queued()
{
    const std::uint64_t begin = queue_begin_.load(std::memory_order_relaxed);
    // acquire: the index, and the buffer's content.
    if (begin == queue_end_.load(std::memory_order_acquire)) {
        return nullptr;
    }
    ImageBuffer& next = at(queued(begin));
    // unpin() counts it off again.
    held_.fetch_add(1, std::memory_order_relaxed);
    // release: what was given back before is seen to be back by who finds this place free.
    queue_begin_.store(begin + 1, std::memory_order_release);
    return &next;
}

ImageBuffer* ImagePool::pin()
{
    // acquire: pairs with the release in unpin(), so that a pin whose place this one takes is seen
    // to be given back by everyone who sees this one.
    if (held_.fetch_add(1, std::memory_order_acquire) >= max_pins_) {
        held_.fetch_sub(1, std::memory_order_relaxed);
        return nullptr;
    }
    // acquire: the buffer's content. It lies behind the exchange in publish() also for the second
    // and later pins, whose fetch_adds continue its release sequence. release: see publish().
    // 48 bits count the pins of one scan: nine years of a million per second.
    const std::uint64_t index = latest_.fetch_add(1, std::memory_order_acq_rel) >> index_shift;
    if (index == no_buffer) {
        held_.fetch_sub(1, std::memory_order_release);
        return nullptr;
    }
    return &at(index);
}

void ImagePool::unpin(ImageBuffer& buffer)
{
    // release: the task overwrites the buffer only after our last look at it. This comes first:
    // whoever is admitted in our place must find it done.
    buffer.released_.fetch_add(1, std::memory_order_release);
    held_.fetch_sub(1, std::memory_order_release);
}

bool ImagePool::is_empty() const
{
    return latest_.load(std::memory_order_relaxed) >> index_shift == no_buffer;
}

} // namespace busbar::server::detail
