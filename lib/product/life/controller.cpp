#include <busbar/product/controller.hpp>

#include <csignal>
#include <cstdlib>
#include <mutex>
#include <utility>

#include <busbar/controller/plc_task.hpp>
#include <busbar/net/system.hpp>

#include "running_controller.hpp"
#include "start.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

/// Lets these signals end the process at once until the server's loop handles them: nothing needs
/// cleaning up before that.
void end_at_once_on_signals()
{
    for (const int number : {SIGTERM, SIGINT}) {
        std::signal(number, [](int) { std::_Exit(0); });
    }
}

/// Holds SIGHUP for the next controller while there is none. Threads of the calling thread inherit
/// this.
void hold_hangups()
{
    ::sigset_t hangup;
    ::sigemptyset(&hangup);
    ::sigaddset(&hangup, SIGHUP);
    ::pthread_sigmask(SIG_BLOCK, &hangup, nullptr);
}

} // namespace

Configured<void> check(const Configuration& configuration)
{
    try {
        static_cast<void>(read_sources(configuration));
        return {};
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

struct Controller::Parts {
    Parts(Configuration where, Runtime& plc, const ControllerOptions& wanted)
        : configuration{std::move(where)}, runtime{plc}, options{wanted}
    {
        if (options.log == nullptr) {
            options.log = &lines;
        }
    }

    /// Until a controller exists, signals end the process at once.
    [[nodiscard]] Configured<std::unique_ptr<RunningController>> make()
    {
        if (options.takes_signals) {
            end_at_once_on_signals();
        }
        try {
            return start(configuration, runtime, *options.log, options, threads);
        } catch (const ConfigError& error) {
            return Unexpected{error.problem()};
        }
    }

    Configuration configuration;
    Runtime& runtime;
    ControllerOptions options;
    net::StderrLog lines{LogLevel::Debug};
    /// Made before the others give way.
    controller::ThreadMaker threads;
    std::mutex mutex; // guards the two below
    std::unique_ptr<RunningController> running;
    bool stops{false};
};

Controller::Controller(std::unique_ptr<Parts> parts) : parts_{std::move(parts)} {}
Controller::~Controller() = default;

Configured<std::unique_ptr<Controller>>
Controller::create(Configuration configuration, Runtime& runtime, const ControllerOptions& options)
{
    if (options.takes_signals) {
        hold_hangups();
    }
    auto parts = std::make_unique<Parts>(std::move(configuration), runtime, options);
    // All threads but the PLC's, which so goes before them.
    net::give_way();
    auto made = parts->make();
    if (!made) {
        return Unexpected{std::move(made).error()};
    }
    parts->running = *std::move(made);
    return std::unique_ptr<Controller>{new Controller{std::move(parts)}};
}

Configured<void> Controller::run()
{
    while (parts_->running->run()) {
        {
            const std::lock_guard lock{parts_->mutex};
            parts_->running.reset(); // lets go of its logs first
        }
        auto next = parts_->make();
        if (!next) {
            return Unexpected{std::move(next).error()};
        }
        const std::lock_guard lock{parts_->mutex};
        parts_->running = *std::move(next);
        if (parts_->stops) {
            parts_->running->stop();
        }
    }
    return {};
}

void Controller::stop()
{
    const std::lock_guard lock{parts_->mutex};
    parts_->stops = true;
    if (parts_->running != nullptr) {
        parts_->running->stop();
    }
}

void Controller::reload()
{
    const std::lock_guard lock{parts_->mutex};
    if (parts_->running != nullptr) {
        parts_->running->reload();
    }
}

} // namespace busbar::product
