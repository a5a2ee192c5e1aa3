#pragma once

#include <memory>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/product/configuration.hpp>
#include <busbar/product/runtime.hpp>

namespace busbar::product {

struct ControllerOptions {
    /// Null: lines on standard error. Must outlive the controller; any thread.
    LogSink* log{nullptr};
    /// SIGTERM and SIGINT end it, SIGHUP is reload(). One controller of a process at most.
    bool takes_signals{true};
    /// Says on standard output how to reach it, what the setup's code is, and when it has stopped.
    bool greets{true};
};

/// A whole controller around a PLC: OPC UA server with security, users, settings, logs, backup,
/// life cycle and model mode, as its configuration says. It starts with what it ran with last if
/// what is there now makes none.
class BUSBAR_API Controller {
public:
    /// `runtime` must outlive it. Reads the configuration, makes what is missing, such as a
    /// certificate, and listens. The calling thread, which should be the one of run(), and the
    /// controller's threads give way to others from now on, but for the PLC's task.
    ///
    /// The problem is that there is no way to start: the configuration never made a controller, or
    /// there is nobody who could log in.
    [[nodiscard]] static Configured<std::unique_ptr<Controller>>
    create(Configuration configuration, Runtime& runtime, const ControllerOptions& options = {});
    Controller(const Controller&) = delete;
    Controller& operator=(const Controller&) = delete;
    ~Controller();

    /// Serves until stop(), a signal or an administrator ends it, and starts anew where an
    /// administrator wants that. Once. The problem is that it cannot start anew.
    [[nodiscard]] Configured<void> run();
    /// Has run() end: clients are told first. Any thread, also before run().
    void stop();
    /// Reads users, trust lists, settings and the program again, and puts in force what can be. Any
    /// thread.
    void reload();

private:
    struct Parts;
    explicit Controller(std::unique_ptr<Parts> parts);

    std::unique_ptr<Parts> parts_;
};

} // namespace busbar::product
