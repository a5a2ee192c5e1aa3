#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/controller/simulated_labels.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The simulated PLC that a server of model mode serves the labels of. It is a machine of its own:
/// it goes on while servers come and go, and its program changes when somebody downloads one.
///
/// On the server's thread, but for what PlcTask calls.
class LabelPlant {
public:
    /// Throws ConfigError. `clock` must outlive it.
    LabelPlant(const ControllerConfig& config, const WallClock& clock);
    LabelPlant(const LabelPlant&) = delete;
    LabelPlant& operator=(const LabelPlant&) = delete;
    ~LabelPlant() { stop(); }

    void start() { task_->start(); }
    /// What waits for the PLC answers NoCommunication.
    void stop();
    /// What the system granted to the task.
    [[nodiscard]] int task_priority() const { return task_->realtime_priority(); }
    /// For one listener at a time.
    [[nodiscard]] std::shared_ptr<backend::LabelBackend> labels() const { return labels_; }
    /// Those that there would be with the program of this configuration. Throws ConfigError.
    [[nodiscard]] std::shared_ptr<const backend::LabelBackend>
    labels_with(const ControllerConfig& next) const;

    /// An online change, if the configuration has another program than before: whether it has.
    /// Throws ConfigError, and then nothing has changed.
    bool download(const ControllerConfig& next);

private:
    [[nodiscard]] std::unique_ptr<controller::Plc> make_plc(const ControllerConfig& config) const;
    /// The task's, after each scan.
    void end_of_scan(DateTime time);

    const WallClock& clock_;
    std::shared_ptr<const std::string> program_text_;
    std::shared_ptr<controller::SimulatedLabels> labels_;
    /// Guards what follows. The task does not wait for it: it looks again after the next scan.
    std::mutex mutex_;
    /// Two while a program is about to be replaced.
    std::vector<std::unique_ptr<controller::Plc>> plcs_;
    /// Which of them scans.
    controller::Plc* current_{nullptr};
    std::optional<controller::PlcTask> task_;
};

} // namespace busbar::product
