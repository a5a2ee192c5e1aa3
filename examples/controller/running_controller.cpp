#include "running_controller.hpp"

#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <busbar/client/registration.hpp>
#include <busbar/server/running_server.hpp>

#include "startup.hpp"
#include "ticker.hpp"
#include "toml_reader.hpp"

namespace busbar::example {

namespace {

bool has_terminal()
{
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    return terminal >= 0 && ::close(terminal) == 0;
}

Standing standing_of(const ControllerConfig& config)
{
    Standing standing{config.address,   config.port, config.reverse_urls,
                      config.discovery, {},          config.key_log};
    if (!config.discovery.url.empty()) {
        ControllerConfig named = config;
        set_names(named);
        standing.application_uri = named.server.application_uri;
    }
    return standing;
}

} // namespace

RunningController::RunningController(Origin origin, Reading reading)
    : origin_{std::move(origin)}, has_terminal_{has_terminal()}
{
    const ControllerConfig config = reading.config;
    if (config.machine.program) {
        machine_.emplace(config, clock_, log_);
    }
#ifdef BUSBAR_KEY_LOG
    if (!config.key_log.empty()) {
        key_log_ = expect(net::KeyLogFile::open(config.key_log, log_), config.key_log);
    }
#endif
    standing_ = standing_of(config);
    listen(config);
    current_ =
        std::make_unique<Generation>(origin_, std::move(reading), surroundings(), requests());
    clients_.use(current_->clients());
    identity_ = current_->config().server.identity;
    register_with_discovery_server(current_->config());
}

/// For clients that come, and those that wait to be connected to.
void RunningController::listen(const ControllerConfig& config)
{
    const auto port = loop_.listen(config.address, config.port);
    if (!port) {
        if (machine_) {
            machine_->cannot_start("it cannot listen on port " + std::to_string(config.port));
        }
        throw ConfigError{Problem{port.error(), "listening", "failed"}};
    }
    port_ = *port;
    net::ReverseConnectConfig reverse;
    reverse.client_urls = config.reverse_urls;
    expect(loop_.connect_to_clients(reverse), "connecting to clients");
}

void RunningController::register_with_discovery_server(const ControllerConfig& config)
{
    if (config.discovery.url.empty()) {
        return;
    }
    client::SecurityWishes wishes;
    wishes.min_mode = MessageSecurityMode::Sign;
    wishes.allows_none = config.discovery.allows_none;
    net::DiscoveryRegistrationConfig registration;
    registration.client = client::registration_client(
        config.discovery.url, wishes, config.server.application_uri, identity_.has_value());
    registration.settings = net::registration_of(config.server, {config.server.endpoint_url});
    registration.settings.interval = config.discovery.interval;
    const channel::ChannelEnvironment environment{.random = &random_,
                                                  .wall_clock = &clock_,
                                                  .log = &log_,
                                                  .validator = &clients_,
                                                  .identity = identity_ ? &*identity_ : nullptr};
    expect(loop_.register_with(std::move(registration), environment),
           "registering with " + config.discovery.url);
}

Surroundings RunningController::surroundings()
{
    server::ServerEnvironment environment{
        .random = &random_, .wall_clock = &clock_, .waker = &loop_.waker()};
#ifdef BUSBAR_KEY_LOG
    environment.key_log = key_log_.get();
#endif
    return {environment, log_, machine_ ? &*machine_ : nullptr, port_};
}

Requests RunningController::requests()
{
    return {.stop = [this] { loop_.stop(); },
            .restart = [this](const administration::RestartWish& wish) { restart(wish); },
            .renewed = [this] { renewed(); },
            .memory_replaced = [this] { loop_.post([this] { machine_->memory_replaced(); }); }};
}

/// Not to a generation that is being left: nobody can ask it any more.
void RunningController::renewed()
{
    const auto& identity = current_->config().server.identity;
    if (identity_ && identity) { // a registration refers to it
        identity_ = identity;
    }
}

void RunningController::try_to(FunctionRef<void()> change)
{
    try {
        change();
    } catch (const ConfigError& error) {
        log_.write(LogLevel::Error, "controller",
                   std::string{error.what()} + "; nothing was changed");
    }
}

void RunningController::restart(const administration::RestartWish& wish)
{
    loop_.post([this, wish] {
        try_to([&] {
            replace(Machine::Cause::Restart, read(origin_),
                    {.reason = wish.reason, .delay = wish.delay, .return_time = wish.return_time});
        });
    });
}

void RunningController::replace(Machine::Cause cause, Reading reading, net::Handover handover)
{
    const bool has_fitting_machine =
        machine_ ? machine_->fits(reading.config) : reading.config.machine.program == nullptr;
    if (!has_fitting_machine || !(standing_of(reading.config) == standing_)) {
        return start_again(handover);
    }
    take_over(std::make_unique<Generation>(origin_, std::move(reading), surroundings(), requests()),
              std::move(handover));
    if (machine_) {
        machine_->replace(cause, *current_->plant().program(), current_->config());
    }
    clients_.use(current_->clients());
    renewed();
    leaving_.back()->print_statistics();
    current_->print_welcome();
}

bool RunningController::download()
{
    Reading reading = read(origin_);
    const MachineConfig& machine = reading.config.machine;
    if (!machine.program || *machine.program_text == *current_->config().machine.program_text) {
        return false;
    }
    const std::string file = machine.program_file;
    if (const auto edited = current_->edit(reading)) {
        log_.write(LogLevel::Info, "controller", "edited online: " + file);
        return false;
    }
    replace(Machine::Cause::Download, std::move(reading),
            {.reason = "a program is downloaded to the controller"});
    log_.write(LogLevel::Info, "controller", "downloaded: " + file);
    return true;
}

void RunningController::take_over(std::unique_ptr<Generation> next, net::Handover handover)
{
    Generation& before = *current_;
    before.halt();
    // Whose last scan has the values that the next one begins with.
    try {
        save_retained();
        handover.released = [this, &before] { release(before); };
        expect(loop_.hand_over(next->server(), std::move(handover)));
    } catch (const ConfigError&) {
        before.start();
        throw;
    }
    leaving_.push_back(std::exchange(current_, std::move(next)));
    start();
    look_soon();
}

void RunningController::save_retained()
{
    if (machine_) {
        machine_->save_retained();
    }
}

void RunningController::start()
{
    if (machine_) {
        machine_->keep(*current_->plant().program());
    }
    current_->start();
}

/// With other listeners, or another machine, which has to let go of its logs first.
void RunningController::start_again(const net::Handover& handover)
{
    const bool begins = server::RunningServer{current_->server()}.begin_shutdown(
        handover.reason, handover.delay, handover.return_time);
    if (begins) {
        starts_again_ = true;
        loop_.stop();
    }
}

/// Not yet where nobody is connected, as this is called while it is being handed over then.
void RunningController::release(const Generation& gone)
{
    loop_.post([this, &gone] {
        std::erase_if(leaving_, [&gone](const auto& one) { return one.get() == &gone; });
    });
}

/// What fails changes nothing: the reason goes to the log. A signal because the terminal was closed
/// ends the controller, as it does other programs in a terminal.
void RunningController::hang_up()
{
    if (has_terminal_ && !has_terminal()) {
        loop_.stop();
        return;
    }
    try_to([this] {
        if (machine_ && download()) {
            return;
        }
        log_.write(LogLevel::Info, "controller", current_->reload());
    });
}

void RunningController::look_soon()
{
    loop_.post([this] { current_->look(); });
}

bool RunningController::run()
{
    start();
    loop_.stop_on_signals([this] {
        if (machine_) {
            machine_->power_going();
        }
    });
    loop_.on_hangup([this] { hang_up(); });
    current_->print_welcome();
    if (machine_) {
        machine_->run(*current_->plant().program(), current_->config().server.endpoint_url);
    }
    const Ticker ticker{lookout_period, [this] { look_soon(); }};
    loop_.run(current_->server());
    current_->halt();
    if (machine_) {
        machine_->shut_down();
    }
    current_->print_statistics();
    std::puts(starts_again_ ? "starting again" : "stopped");
    std::fflush(stdout);
    return starts_again_;
}

} // namespace busbar::example
