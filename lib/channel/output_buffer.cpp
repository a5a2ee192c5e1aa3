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
    if (storage_.size() - end_ < size && begin_ != 0) {
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
