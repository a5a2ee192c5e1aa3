#pragma once

#include <atomic>
#include <memory>

#include <busbar/backend/label_backend.hpp>
#include <busbar/core/detail/hand_over.hpp>

namespace busbar::controller::detail {

/// Receives answers from a PLC's thread for the server's. Any thread may call the listener's
/// functions; the others belong to the server's thread.
class LabelInbox final : public backend::LabelListener {
public:
    LabelInbox() = default;
    ~LabelInbox() override;

    void done(std::unique_ptr<backend::LabelRequest> request) override;
    void labels_changed() override;

    /// Returns the oldest answer; null if there is none.
    [[nodiscard]] std::unique_ptr<backend::LabelRequest> take();
    /// True if the labels changed since the last call.
    [[nodiscard]] bool take_change() { return has_changed_.exchange(false); }
    [[nodiscard]] busbar::detail::WakerSlot& waker() { return waker_; }

private:
    busbar::detail::HandOver<backend::LabelRequest> done_;
    /// Answers that were fetched but not taken yet, oldest first.
    std::unique_ptr<backend::LabelRequest> found_;
    std::atomic<bool> has_changed_{false};
    busbar::detail::WakerSlot waker_;
};

} // namespace busbar::controller::detail
