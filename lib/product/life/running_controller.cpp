#include "running_controller.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <busbar/client/registration.hpp>
#include <busbar/server/running_server.hpp>

#include "product/configuration/toml_reader.hpp"
#include "product/machine/ticker.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

bool has_terminal()
{
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    return terminal >= 0 && ::close(terminal) == 0;
}

Standing standing_of(const ControllerConfig& config)
{
    Standing standing{.is_used = config.machine.is_used,
                      .address = config.address,
                      .port = config.port,
                      .use = config.use,
                      .further_listeners = config.further_listeners,
                      .reverse_urls = config.reverse_urls,
                      .discovery = config.discovery,
                      .application_uri = {},
                      .key_log = config.key_log};
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
        machine_.emplace(config, clock_, log_, [this](bool is_in) {
            loop_.post([this, is_in] { machine_->medium_is(is_in); });
        });
    }
    if (reading.project != nullptr) {
        labels_.emplace(config, clock_);
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
    if (!config.machine.is_used) {
        port_ = config.port;
        return;
    }
    port_ = expect_listener({config.address, config.port, config.use});
    for (const FurtherListener& each : config.further_listeners) {
        static_cast<void>(expect_listener(each));
    }
    net::ReverseConnectConfig reverse;
    reverse.client_urls = config.reverse_urls;
    expect(loop_.connect_to_clients(reverse), "connecting to clients");
}

std::uint16_t RunningController::expect_listener(const FurtherListener& listener)
{
    const auto port =
        loop_.listen(listener.address, listener.port, static_cast<std::uint32_t>(listener.use));
    if (!port) {
        if (machine_) {
            machine_->cannot_start("it cannot listen on port " + std::to_string(listener.port));
        }
        throw ConfigError{Problem{port.error(), "listening", "failed"}};
    }
    return *port;
}

void RunningController::register_with_discovery_server(const ControllerConfig& config)
{
    if (config.discovery.url.empty() || !config.machine.is_used) {
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
    return {environment, log_, machine_ ? &*machine_ : nullptr, labels_ ? &*labels_ : nullptr,
            port_};
}

Requests RunningController::requests()
{
    return {
        .stop = [this] { loop_.stop(); },
        .restart = [this](const administration::RestartWish& wish) { restart(wish); },
        .renewed =
            [this] {
                renewed();
                changed(&controller::LifeCycle::certificate_renewed);
            },
        .address_changed = [this] { changed(&controller::LifeCycle::address_changed); },
        .hardware = [this](HardwareEvent event) { loop_.post([this, event] { happen(event); }); },
        .memory_replaced = [this] { loop_.post([this] { machine_->memory_replaced(); }); }};
}

/// Not in a callback of the server's, and of the server that serves then.
void RunningController::changed(Machine::Change change)
{
    if (machine_) {
        loop_.post([this, change] {
            machine_->changed(change, *current_->plant().program(),
                              current_->config().server.endpoint_url);
        });
    }
}

/// Clients may see why, and an administrator may have it start again.
void RunningController::happen(HardwareEvent event)
{
    if (machine_->happen(event)) {
        log_.write(LogLevel::Error, "controller",
                   "the hardware has the OPC UA server halt, until a restart");
        server::RunningServer{current_->server()}.change_state(
            ServerState::Failed, "the hardware has the OPC UA server halt", {});
    }
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
    Standing next = standing_of(reading.config);
    if (!has_fitting_machine || !(next == standing_ || moves(next))) {
        check_listeners(next);
        return start_again(handover);
    }
    const std::uint16_t port_before = port_;
    if (!(next == standing_)) {
        port_ = expect_port(next);
    }
    try {
        take_over(
            std::make_unique<Generation>(origin_, std::move(reading), surroundings(), requests()),
            std::move(handover));
    } catch (const ConfigError&) {
        leave_port(std::exchange(port_, port_before));
        throw;
    }
    leave_port(port_before);
    standing_ = std::move(next);
    if (labels_) {
        labels_->download(current_->config());
    }
    if (machine_) {
        machine_->replace(cause, *current_->plant().program(), current_->config());
    }
    clients_.use(current_->clients());
    renewed();
    leaving_.back()->print_statistics();
    current_->print_welcome();
}

/// Nothing but where it listens, and so that both can be open at the same time. A registration has
/// the old URL in it.
bool RunningController::moves(const Standing& next) const
{
    Standing before = standing_;
    before.address = next.address;
    before.port = next.port;
    return before == next && next.is_used && next.discovery.url.empty() && next.port != port_ &&
           next.further_listeners.empty(); // a port is left at all addresses
}

std::uint16_t RunningController::expect_port(const Standing& next)
{
    const auto port = loop_.listen(next.address, next.port, static_cast<std::uint32_t>(next.use));
    if (!port) {
        throw ConfigError{
            Problem{port.error(), "server.port", "cannot listen on " + std::to_string(next.port)}};
    }
    return *port;
}

/// Whether all can be opened, so that it is not left with none in the end. One at a port that is
/// open now cannot be tried there: its address can.
void RunningController::check_listeners(const Standing& next)
{
    if (!next.is_used) {
        return;
    }
    std::vector<FurtherListener> all = next.further_listeners;
    all.insert(all.begin(), {next.address, next.port, next.use});
    for (const FurtherListener& each : all) {
        const bool is_open = each.port == port_ ||
                             std::ranges::any_of(standing_.further_listeners, [&](const auto& now) {
                                 return now.port == each.port;
                             });
        const auto port = loop_.listen(each.address, is_open ? std::uint16_t{0} : each.port);
        if (!port) {
            const std::string at = each.address.empty() ? "" : " of " + each.address;
            throw ConfigError{Problem{port.error(), "server.port",
                                      "cannot listen on " + std::to_string(each.port) + at}};
        }
        loop_.stop_listening(*port);
    }
}

void RunningController::leave_port(std::uint16_t port)
{
    if (port != port_) {
        loop_.stop_listening(port);
    }
}

void RunningController::check_download(const ControllerConfig& next, const Problem& edit) const
{
    if (next.machine.is_used != current_->config().machine.is_used) {
        throw ConfigError{"machine.use", "changes with a restart of the controller only"};
    }
    const auto is_in_run = [](const MachineConfig& machine) {
        return machine.mode == controller::MachineMode::Run;
    };
    if (is_in_run(current_->config().machine) && is_in_run(next.machine)) {
        throw ConfigError{next.machine.program_file,
                          text(edit) + "; a download waits until the machine is not in RUN: set "
                                       "mode = \"PROGRAM\" in [machine] for it"};
    }
}

bool RunningController::download()
{
    Reading reading = read(origin_);
    const MachineConfig& machine = reading.config.machine;
    if (!machine.program || *machine.program_text == *current_->config().machine.program_text) {
        return false;
    }
    const std::string file = machine.program_file;
    const auto edited = current_->edit(reading);
    if (edited) {
        log_.write(LogLevel::Info, "controller", "edited online: " + file);
        return false;
    }
    check_download(reading.config, edited.error());
    replace(Machine::Cause::Download, std::move(reading),
            {.reason = "a program is downloaded to the controller"});
    log_.write(LogLevel::Info, "controller", "downloaded: " + file);
    return true;
}

void RunningController::download_labels()
{
    if (!labels_ || origin_.file.empty()) {
        return;
    }
    const ControllerConfig next = Settings{origin_.file, origin_.preset}.config();
    if (labels_->download(next)) {
        log_.write(LogLevel::Info, "controller", "downloaded: " + next.labels.program_file);
    }
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
        download_labels();
        log_.write(LogLevel::Info, "controller", current_->reload());
    });
}

void RunningController::look_soon()
{
    loop_.post([this] { current_->look(); });
}

bool RunningController::run()
{
    if (labels_) {
        labels_->start();
    }
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
    const Ticker ticker{[this] {
        look_soon();
        return lookout_period;
    }};
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

} // namespace busbar::product
