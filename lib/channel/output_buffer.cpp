#include "output_buffer.hpp"

#include <algorithm>

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
    if (storage_.size() > max_idle_size) {
        storage_ = {};
    }
}

std::span<std::byte> OutputBuffer::reserve(std::size_t size)
{
    // Only where as much was sent as is moved, so that a slow reader costs no copy per chunk.
    if (storage_.size() - end_ < size && begin_ != 0 && begin_ >= end_ - begin_) {
        std::copy(storage_.begin() + static_cast<std::ptrdiff_t>(begin_),
                  storage_.begin() + static_cast<std::ptrdiff_t>(end_), storage_.begin());
        end_ -= begin_;
        begin_ = 0;
    }
    if (storage_.size() - end_ < size) {
        storage_.resize(std::max(end_ + size, storage_.size() + storage_.size() / 2));
    }
    return std::span{storage_}.subspan(end_, size);
}

} // namespace busbar::channel::detail
