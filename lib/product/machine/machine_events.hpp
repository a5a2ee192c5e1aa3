#pragma once

#include <mutex>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/core/log.hpp>

namespace busbar::product {

/// Passes a machine's events to the present server, which may be replaced, and writes each to the
/// program's log, with what to do. Thread-safe.
class MachineEvents final : public controller::MachineEventListener {
public:
    /// `lines`, which must not be the event log, must outlive this object.
    explicit MachineEvents(LogSink& lines) : lines_{lines} {}

    /// Passes events to `listener` only, from now on; null for no listener.
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
        lines_.write(log_level(event.level), "event log", what_to_do(event));
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
    [[nodiscard]] static LogLevel log_level(controller::EventLevel level)
    {
        switch (level) {
        case controller::EventLevel::Information:
            return LogLevel::Info;
        case controller::EventLevel::Observation:
            return LogLevel::Warning;
        default:
            return LogLevel::Error;
        }
    }

    LogSink& lines_;
    std::mutex mutex_; // guards the listener, which stays while it is told
    controller::MachineEventListener* listener_{nullptr};
};

} // namespace busbar::product
