#pragma once

#include <mutex>

#include <busbar/controller/machine_event_log.hpp>

namespace busbar::product {

/// Passes a machine's events on to the server that serves, of which there may be another later. Any
/// thread.
class MachineEvents final : public controller::MachineEventListener {
public:
    /// From now on to `listener`, and to nobody else any more; null: to nobody.
    void tell(controller::MachineEventListener* listener)
    {
        const std::lock_guard lock{mutex_};
        listener_ = listener;
        if (listener_ != nullptr) {
            listener_->errors_changed();
        }
    }
    void happened(const controller::MachineEvent& event) override
    {
        const std::lock_guard lock{mutex_};
        if (listener_ != nullptr) {
            listener_->happened(event);
        }
    }
    void errors_changed() override
    {
        const std::lock_guard lock{mutex_};
        if (listener_ != nullptr) {
            listener_->errors_changed();
        }
    }

private:
    std::mutex mutex_; // of the listener, which stays while it is told
    controller::MachineEventListener* listener_{nullptr};
};

} // namespace busbar::product
