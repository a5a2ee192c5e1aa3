#include "label_inbox.hpp"

#include <utility>

namespace busbar::controller::detail {

using backend::LabelRequest;

namespace {

/// One by one: a chain would free itself recursively.
void free_chain(std::unique_ptr<LabelRequest> first)
{
    while (first != nullptr) {
        first = std::move(first->next);
    }
}

} // namespace

LabelInbox::~LabelInbox()
{
    free_chain(std::move(found_));
    free_chain(std::unique_ptr<LabelRequest>{newest_.exchange(nullptr)});
}

void LabelInbox::done(std::unique_ptr<LabelRequest> request)
{
    LabelRequest* const added = request.release();
    LabelRequest* before = newest_.load();
    do {
        static_cast<void>(added->next.release()); // of the try before: the queue's, not its own
        added->next.reset(before);
    } while (!newest_.compare_exchange_weak(before, added));
    if (before == nullptr) {
        wake();
    }
}

void LabelInbox::labels_changed()
{
    has_changed_ = true;
    wake();
}

std::unique_ptr<LabelRequest> LabelInbox::take()
{
    if (found_ == nullptr) {
        std::unique_ptr<LabelRequest> newest{newest_.exchange(nullptr)};
        while (newest != nullptr) {
            std::unique_ptr<LabelRequest> older = std::move(newest->next);
            newest->next = std::move(found_);
            found_ = std::move(newest);
            newest = std::move(older);
        }
    }
    std::unique_ptr<LabelRequest> oldest = std::move(found_);
    if (oldest != nullptr) {
        found_ = std::move(oldest->next);
    }
    return oldest;
}

void LabelInbox::set_waker(server::Waker* waker)
{
    waker_ = waker;
    while (wakers_running_ != 0) {
        // A PLC's thread is inside Waker::wake, which does not block.
    }
}

void LabelInbox::wake()
{
    ++wakers_running_;
    if (server::Waker* const waker = waker_; waker != nullptr) {
        waker->wake();
    }
    --wakers_running_;
}

} // namespace busbar::controller::detail
