#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <busbar/backend/label_backend.hpp>
#include <busbar/server/waker.hpp>

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
    /// Null: when it returns, the one before is not used any more.
    void set_waker(server::Waker* waker);

private:
    void wake();

    /// The newest, which owns those before it by `next`.
    std::atomic<backend::LabelRequest*> newest_{nullptr};
    /// Those that take() has found, the oldest first.
    std::unique_ptr<backend::LabelRequest> found_;
    std::atomic<bool> has_changed_{false};
    std::atomic<server::Waker*> waker_{nullptr};
    std::atomic<std::uint32_t> wakers_running_{0};
};

} // namespace busbar::controller::detail
