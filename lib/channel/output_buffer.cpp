#include "output_buffer.hpp"

#include <cstring>
#include <utility>

namespace busbar::channel::detail {

namespace {

/// What an idle connection may hold on to.
constexpr std::size_t max_idle_size = 1U << 20U;

} // namespace

void OutputBuffer::consume(std::size_t size)
{
    begin_ += size;
    consumed_ += size;
    shrink_if_idle();
}

void OutputBuffer::roll_back(std::size_t position)
{
    end_ = begin_ + (position - consumed_);
    shrink_if_idle();
}

void OutputBuffer::shrink_if_idle()
{
    if (begin_ != end_) {
        return;
    }
    begin_ = end_ = 0;
    if (capacity_ > max_idle_size) {
        storage_.reset();
        capacity_ = 0;
    }
}

void OutputBuffer::move_to_front(std::byte* front)
{
    if (begin_ != end_) {
        std::memmove(front, storage_.get() + begin_, end_ - begin_);
    }
    end_ -= begin_;
    begin_ = 0;
}

std::span<std::byte> OutputBuffer::reserve(std::size_t size)
{
    if (capacity_ - end_ < size) {
        // Half of what waits is free behind it then, so that each byte is moved a few times at
        // most, however slowly the peer reads.
        const std::size_t needed = max_capacity(end_ - begin_, size);
        if (needed <= capacity_) {
            move_to_front(storage_.get());
        } else {
            auto larger = std::make_unique_for_overwrite<std::byte[]>(needed);
            move_to_front(larger.get());
            storage_ = std::move(larger);
            capacity_ = needed;
        }
    }
    return {storage_.get() + end_, size};
}

} // namespace busbar::channel::detail
