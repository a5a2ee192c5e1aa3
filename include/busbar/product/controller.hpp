#pragma once

#include <memory>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/product/configuration.hpp>
#include <busbar/product/runtime.hpp>

namespace busbar::product {

/// The options of a controller within a program.
struct ControllerOptions {
    /// If null, lines are written to standard error. Must outlive the controller; called from any
    /// thread.
    LogSink* log{nullptr};
    /// SIGTERM and SIGINT end it, SIGHUP calls reload(). At most one controller of a process.
    bool takes_signals{true};
    /// Prints on standard output how to reach it, the setup's code, and when it has stopped.
    bool greets{true};
};

/// A whole controller around a PLC: OPC UA server with security, users, settings, logs, backup,
/// life cycle and model mode, as its configuration says. It starts with its last working
/// configuration if the present one is invalid.
class BUSBAR_API Controller {
public:
    /// `runtime` must outlive it. Reads the configuration, creates missing files, such as a
    /// certificate, and listens. The calling thread, which should be the one of run(), and the
    /// controller's threads have lower priority from now on, except for the PLC's task.
    ///
    /// The problem is that it cannot start at all: no configuration ever worked, or no user could
    /// log in.
    [[nodiscard]] static Configured<std::unique_ptr<Controller>>
    create(Configuration configuration, Runtime& runtime, const ControllerOptions& options = {});
    Controller(const Controller&) = delete;
    Controller& operator=(const Controller&) = delete;
    ~Controller();

    /// Serves until stop(), a signal or an administrator ends it, and restarts on an
    /// administrator's request. Called once. The problem is that it cannot restart.
    [[nodiscard]] Configured<void> run();
    /// Ends run(): clients are notified first. Called from any thread, also before run().
    void stop();
    /// Reads users, trust lists, settings and the program again, and puts in force what it can.
    /// Called from any thread.
    void reload();

private:
    struct Parts;
    explicit Controller(std::unique_ptr<Parts> parts);

    std::unique_ptr<Parts> parts_;
};

} // namespace busbar::product
