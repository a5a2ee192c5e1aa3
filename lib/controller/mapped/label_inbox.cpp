#include "label_inbox.hpp"

#include <utility>

namespace busbar::controller::detail {

using backend::LabelRequest;

namespace {

/// Frees one request after the other: freeing a chain by its head would recurse.
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
    free_chain(std::unique_ptr<LabelRequest>{done_.take()});
}

void LabelInbox::done(std::unique_ptr<LabelRequest> request)
{
    if (done_.push(*request.release())) {
        waker_.wake();
    }
}

void LabelInbox::labels_changed()
{
    has_changed_ = true;
    waker_.wake();
}

std::unique_ptr<LabelRequest> LabelInbox::take()
{
    if (found_ == nullptr) {
        found_.reset(done_.take());
    }
    std::unique_ptr<LabelRequest> oldest = std::move(found_);
    if (oldest != nullptr) {
        found_ = std::move(oldest->next);
    }
    return oldest;
}

} // namespace busbar::controller::detail
