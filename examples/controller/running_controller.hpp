#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#ifdef BUSBAR_KEY_LOG
#include <busbar/net/key_log_file.hpp>
#endif

#include "current_validator.hpp"
#include "generation.hpp"
#include "machine.hpp"
#include "reading.hpp"

namespace busbar::example {

/// A controller while it runs: its listeners, its machine with life and logs, and the Generation
/// that serves.
class RunningController {
public:
    /// Listens, and makes the first generation. Throws ConfigError.
    RunningController(Origin origin, Reading reading);
    RunningController(const RunningController&) = delete;
    RunningController& operator=(const RunningController&) = delete;

    /// Serves until it is stopped. True if it is to start again, with everything anew.
    [[nodiscard]] bool run();

private:
    void listen(const ControllerConfig& config);
    void register_with_discovery_server(const ControllerConfig& config);
    [[nodiscard]] Surroundings surroundings();
    [[nodiscard]] Requests requests();
    void hang_up();
    void renewed();

    Origin origin_;
    net::StderrLog log_{LogLevel::Debug};
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    net::ServerLoop loop_{log_};
#ifdef BUSBAR_KEY_LOG
    std::unique_ptr<net::KeyLogFile> key_log_;
#endif
    std::optional<Machine> machine_;
    std::uint16_t port_{0};
    CurrentValidator clients_;
    /// The current generation's, for the discovery server.
    std::optional<channel::ApplicationIdentity> identity_;
    std::unique_ptr<Generation> current_;
    bool has_terminal_;
    bool starts_again_{false};
};

} // namespace busbar::example
