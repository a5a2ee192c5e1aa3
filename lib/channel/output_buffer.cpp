#include "output_buffer.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

namespace busbar::channel::detail {

namespace {

/// Maximum size that an idle connection keeps without shared buffers.
constexpr std::size_t max_idle_size = 1U << 20U;
/// Maximum number of bytes that are moved to a block that others will need again: a slow peer must
/// not make each small answer cost a copy of all before it.
constexpr std::size_t max_moved_size = 64U << 10U;

} // namespace

OutputBuffer::~OutputBuffer()
{
    if (spares_ != nullptr) {
        spares_->give_back(*this, std::move(block_));
    }
}

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

void OutputBuffer::fill_gap(std::span<const std::byte> message)
{
    static_cast<void>(reserve(message.size()));
    std::byte* const place = block_.bytes.get() + begin_ + (*gap_ - consumed_);
    const auto behind = static_cast<std::size_t>(block_.bytes.get() + end_ - place);
    if (behind != 0) {
        std::memmove(place + message.size(), place, behind);
    }
    std::copy(message.begin(), message.end(), place);
    commit(message.size());
    gap_.reset();
}

void OutputBuffer::drop_gap()
{
    if (gap_) {
        roll_back(*std::exchange(gap_, std::nullopt));
    }
}

void OutputBuffer::shrink_if_idle()
{
    if (begin_ != end_) {
        return;
    }
    begin_ = end_ = 0;
    if (spares_ != nullptr) {
        spares_->give_back(*this, std::exchange(block_, {}));
    } else if (block_.size > max_idle_size) {
        block_ = {};
    }
}

void OutputBuffer::move_to(std::byte* front)
{
    if (begin_ != end_) {
        std::memmove(front, block_.bytes.get() + begin_, end_ - begin_);
    }
    end_ -= begin_;
    begin_ = 0;
}

Block OutputBuffer::leave_block()
{
    const std::size_t size = end_ - begin_;
    if (size == 0) {
        begin_ = end_ = 0;
        return std::exchange(block_, {});
    }
    if (size > block_.size / 2) {
        return {};
    }
    std::unique_ptr<std::byte[]> own{new (std::nothrow) std::byte[size]};
    if (!own) {
        return {};
    }
    move_to(own.get());
    return std::exchange(block_, {std::move(own), size});
}

void OutputBuffer::grow(std::size_t size, std::size_t needed)
{
    const std::size_t waiting = end_ - begin_;
    const bool may_borrow =
        spares_ != nullptr && !spares_->is_lent_to(*this) && waiting <= max_moved_size;
    Block larger = may_borrow ? spares_->lend(*this, waiting + size, needed)
                              : Block{std::make_unique_for_overwrite<std::byte[]>(needed), needed};
    move_to(larger.bytes.get());
    block_ = std::move(larger);
}

std::span<std::byte> OutputBuffer::reserve(std::size_t size)
{
    if (block_.size - end_ < size) {
        // Half of the size is free after it then, so that each byte is moved only a few times,
        // however slowly the peer reads.
        const std::size_t needed = max_capacity(end_ - begin_, size);
        if (needed <= block_.size) {
            move_to(block_.bytes.get());
        } else {
            grow(size, needed);
        }
    }
    return {block_.bytes.get() + end_, size};
}

} // namespace busbar::channel::detail
