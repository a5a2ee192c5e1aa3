#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_events.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/process_image.hpp>

#include "config.hpp"
#include "machine.hpp"

namespace busbar::example {

/// The simulated PLC and what serves it. Must outlive the server that it is published in. On the
/// server's thread, but for raise().
class Plant {
public:
    /// Throws ConfigError. All must outlive it.
    Plant(const ControllerConfig& config, const WallClock& clock, LogSink& lines);

    /// What everything is to be told: a machine's logs, and behind them `lines`.
    [[nodiscard]] LogSink& log();
    /// Adds the PLC's variables, which may be those of a machine's program, its events and Methods,
    /// and information models beside them. Once; throws ConfigError.
    void publish(server::Server& server, LogSink& log);
    /// From publish() on.
    [[nodiscard]] controller::Plc& plc() { return *plc_; }
    /// Clients are let in from now on.
    void run(const std::string& endpoint_url);
    /// Nobody can be let in.
    void cannot_start(const std::string& why);
    /// They are not let in any more.
    void end();
    /// Tells of the events of a scan, by the thread that scans.
    void raise(DateTime time) const { events_->raise(time); }
    /// What clients see as files; they refer to this.
    [[nodiscard]] std::vector<administration::FileSystem> file_systems();
    /// Whether there are other ones than at the last call. Any thread; waits for nothing.
    [[nodiscard]] bool has_changed_files() { return machine_ && machine_->has_changed_files(); }

private:
    const ControllerConfig& config_;
    LogSink& lines_;
    std::optional<Machine> machine_;
    std::unique_ptr<controller::Plc> plc_;
    std::optional<server::ImageSource> source_;
    server::MethodTable methods_;
    std::optional<controller::PlcEvents> events_;
};

} // namespace busbar::example
