#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include <busbar/backend/slmp_labels.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/net/device_driver.hpp>
#include <busbar/net/server_loop.hpp>

namespace busbar::product {

/// The labels of a PLC on the network, for a server of model mode. On the server's thread.
class FieldLabels {
public:
    /// Both must outlive the object.
    FieldLabels(const backend::SlmpLabelsOptions& options, const WallClock& clock, LogSink& log)
        : log_{log}, labels_{std::make_shared<backend::SlmpLabels>(
                         options, clock,
                         [] {
                             return std::chrono::time_point_cast<Duration>(
                                 std::chrono::steady_clock::now());
                         },
                         log)}
    {
    }
    FieldLabels(const FieldLabels&) = delete;
    FieldLabels& operator=(const FieldLabels&) = delete;
    ~FieldLabels() = default;

    /// Connects, and keeps that up while the loop runs.
    void start(net::ServerLoop& loop) { driver_.emplace(loop, labels_->device(), log_); }
    /// Ends the connection, when the loop does not run any more.
    void stop() { driver_.reset(); }
    /// Accepts one listener at a time.
    [[nodiscard]] std::shared_ptr<backend::LabelBackend> labels() const { return labels_; }

private:
    LogSink& log_;
    std::shared_ptr<backend::SlmpLabels> labels_;
    std::optional<net::DeviceDriver> driver_;
};

} // namespace busbar::product
