#include "image_writes.hpp"

namespace busbar::server::detail {

void ImageWrites::push(std::unique_ptr<ImageChanges> changes)
{
    const std::uint64_t position = head_.load(std::memory_order_relaxed);
    bytes_ += changes->memory();
    slot(position) = std::move(changes);
    // release: the task sees the slot and its target in their present state.
    head_.store(position + 1, std::memory_order_release);
}

std::unique_ptr<ImageChanges> ImageWrites::collect()
{
    // acquire: the results that the task has set.
    if (collected_ == finished_.load(std::memory_order_acquire)) {
        return nullptr;
    }
    std::unique_ptr<ImageChanges> changes = std::move(slot(collected_++));
    bytes_ -= changes->memory();
    return changes;
}

void ImageWrites::drop_batches()
{
    // The task may be reading the calls themselves, but never their batches.
    for (std::uint64_t i = collected_; i != head_.load(std::memory_order_relaxed); ++i) {
        slot(i)->drop();
    }
}

ImageChanges* ImageWrites::next()
{
    if (begun_ == head_.load(std::memory_order_acquire)) {
        return nullptr;
    }
    return slot(begun_).get();
}

bool ImageWrites::finish()
{
    if (finished_.load(std::memory_order_relaxed) == begun_) {
        return false;
    }
    // release: the results, and the end of the task's use of the calls.
    finished_.store(begun_, std::memory_order_release);
    return true;
}

} // namespace busbar::server::detail
