#pragma once

#include <functional>
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

/// The simulated PLC whose labels a server of model mode serves. It runs independently of servers,
/// and its program changes when a new one is downloaded.
///
/// Used on the server's thread, except the functions that PlcTask calls, and download().
class LabelPlant {
public:
    /// Throws ConfigError. `clock` must outlive it.
    LabelPlant(const ControllerConfig& config, const WallClock& clock,
               controller::ThreadMaker& threads);
    LabelPlant(const LabelPlant&) = delete;
    LabelPlant& operator=(const LabelPlant&) = delete;
    ~LabelPlant() { stop(); }

    void start() { task_->start(); }
    /// Stops the PLC; requests that wait for it answer NoCommunication.
    void stop();
    /// Priority that the system granted to the task.
    [[nodiscard]] int task_priority() const { return task_->realtime_priority(); }
    /// Accepts one listener at a time.
    [[nodiscard]] std::shared_ptr<backend::LabelBackend> labels() const { return labels_; }
    /// Returns a function for any thread that makes the labels for the program of this
    /// configuration. It throws ConfigError.
    [[nodiscard]] std::function<std::shared_ptr<const backend::LabelBackend>()>
    labels_with(const ControllerConfig& next) const;
    /// The text of the program; null if there is none.
    [[nodiscard]] std::shared_ptr<const std::string> program_text() const;
    /// True if the configuration has another program.
    [[nodiscard]] bool is_other(const ControllerConfig& next) const;

    /// Refuses a program that leaves out what the present one has, unless that is allowed.
    [[nodiscard]] Configured<void> check_left_out(const LabelConfig& next) const;
    /// Tells the log what is left out of the program.
    void tell_left_out(LogSink& log, const std::string& file) const;
    /// Changes the program online to that of the configuration, which takes long: on any thread,
    /// one at a time. Throws ConfigError, with nothing changed.
    void download(const ControllerConfig& next);

private:
    [[nodiscard]] std::unique_ptr<controller::Plc> make_plc(const ControllerConfig& config) const;
    /// Called by the task after each scan.
    void end_of_scan(DateTime time);

    const WallClock& clock_;
    std::shared_ptr<controller::SimulatedLabels> labels_;
    /// Guards the members below. The task does not wait for it but tries again after the next scan.
    mutable std::mutex mutex_;
    std::shared_ptr<const std::string> program_text_;
    /// Contains two elements while a program is about to be replaced.
    std::vector<std::unique_ptr<controller::Plc>> plcs_;
    /// The one that scans.
    controller::Plc* current_{nullptr};
    std::optional<controller::PlcTask> task_;
};

} // namespace busbar::product
