#include "image_pool.hpp"

namespace busbar::server::detail {

void ImageBuffer::fill(const ImageMemory& memory, const ImageSegments& segments, ImageTimes& times,
                       const ImageBuffer* before, DateTime time)
{
    const std::uint64_t filled = scan_;
    const std::uint32_t filled_segments = segments_;
    scan_ = (before != nullptr ? before->scan_ : 0) + 1;
    time_ = time;
    segments_ = segments.count();
    times.fill(memory, {copy_, filled, before != nullptr ? &before->copy_ : nullptr, scan_, time});
    for (std::uint32_t i = 0; i < segments_; ++i) {
        ImageSegment& segment = segments[i];
        const bool was_there = before != nullptr && i < before->segments_;
        segment.times.fill(segment.memory,
                           {segment.copies[index_], i < filled_segments ? filled : 0,
                            was_there ? &segment.copies[before->index_] : nullptr, scan_, time});
    }
}

ImagePool::ImagePool(const ImageLayout& layout, std::uint32_t max_pins, std::uint32_t max_queued)
    : times_{layout}, max_pins_{max_pins}, queue_(max_queued)
{
    for (std::uint32_t i = 0; i < max_pins + max_queued + 3; ++i) {
        buffers_.push_back(std::make_unique<ImageBuffer>(layout, i));
    }
}

std::uint64_t ImagePool::find_free() const
{
    // Try the one that was unused for longest first, since it is most likely free.
    for (std::size_t i = 1; i <= buffers_.size(); ++i) {
        const std::uint64_t index = (current_ + i) % buffers_.size();
        const ImageBuffer& candidate = at(index);
        // acquire: after the release of the last unpin() no reader uses the buffer, and it may be
        // overwritten.
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
    at(next).fill(memory, segments, times_, current_ != no_buffer ? &at(current_) : nullptr, time);
    const std::uint64_t end = queue_end_.load(std::memory_order_relaxed);
    // acquire: the follower has returned what it took out before.
    const bool is_queued = is_followed_.load(std::memory_order_acquire) &&
                           end - queue_begin_.load(std::memory_order_acquire) < queue_.size();
    // release: a reader that pins `next` sees its new content. acquire: a reader that took a pin of
    // the old buffer was admitted after others had returned theirs (see pin); find_free must see
    // these returns, else it could count more than max_pins.
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
    // unpin() decrements it again.
    held_.fetch_add(1, std::memory_order_relaxed);
    // release: the code that finds this place free sees everything that was returned before.
    queue_begin_.store(begin + 1, std::memory_order_release);
    return &next;
}

ImageBuffer* ImagePool::pin()
{
    // acquire: pairs with the release in unpin(), so that everyone who sees this pin also sees the
    // return of the pin that it replaces.
    if (held_.fetch_add(1, std::memory_order_acquire) >= max_pins_) {
        held_.fetch_sub(1, std::memory_order_relaxed);
        return nullptr;
    }
    // acquire: the buffer's content. The exchange in publish() precedes it also for the second and
    // later pins, whose fetch_adds continue its release sequence. release: see publish(). 48 bits
    // count the pins of one scan: nine years of a million per second.
    const std::uint64_t index = latest_.fetch_add(1, std::memory_order_acq_rel) >> index_shift;
    if (index == no_buffer) {
        held_.fetch_sub(1, std::memory_order_release);
        return nullptr;
    }
    return &at(index);
}

void ImagePool::unpin(ImageBuffer& buffer)
{
    // release: the task overwrites the buffer only after our last access. This comes first: the pin
    // that is admitted next must see it.
    buffer.released_.fetch_add(1, std::memory_order_release);
    held_.fetch_sub(1, std::memory_order_release);
}

bool ImagePool::is_empty() const
{
    return latest_.load(std::memory_order_relaxed) >> index_shift == no_buffer;
}

} // namespace busbar::server::detail
