#pragma once

#include <atomic>
#include <memory>

#include <busbar/backend/label_backend.hpp>
#include <busbar/core/detail/hand_over.hpp>

namespace busbar::controller::detail {

/// Answers on their way from a PLC's thread to the server's. Any thread may tell it something; all
/// else is the server's thread's.
class LabelInbox final : public backend::LabelListener {
public:
    LabelInbox() = default;
    ~LabelInbox() override;

    void done(std::unique_ptr<backend::LabelRequest> request) override;
    void labels_changed() override;

    /// The oldest answer; null if there is none.
    [[nodiscard]] std::unique_ptr<backend::LabelRequest> take();
    /// True once for all changes before.
    [[nodiscard]] bool take_change() { return has_changed_.exchange(false); }
    [[nodiscard]] busbar::detail::WakerSlot& waker() { return waker_; }

private:
    busbar::detail::HandOver<backend::LabelRequest> done_;
    /// Those that take() has found, the oldest first.
    std::unique_ptr<backend::LabelRequest> found_;
    std::atomic<bool> has_changed_{false};
    busbar::detail::WakerSlot waker_;
};

} // namespace busbar::controller::detail
