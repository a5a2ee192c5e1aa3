#include <memory>
#include <string>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <busbar/client/registration.hpp>

#include "product/configuration/toml_reader.hpp"
#include "running_controller.hpp"
#include "startup.hpp"

namespace busbar::product {

// How a RunningController begins: what it is made of, and where it listens.

bool has_terminal()
{
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    return terminal >= 0 && ::close(terminal) == 0;
}

Standing standing_of(const ControllerConfig& config)
{
    Standing standing{.is_used = config.machine.is_used,
                      .reverse_urls = config.reverse_urls,
                      .discovery = config.discovery,
                      .application_uri = {},
                      .key_log = config.key_log,
                      .field_labels = config.labels.field_text,
                      .field_password = {}};
    if (config.labels.field != nullptr) {
        standing.field_password = config.labels.field->protocol.password;
    }
    if (!config.discovery.url.empty()) {
        ControllerConfig named = config;
        set_names(named);
        standing.application_uri = named.server.application_uri;
    }
    return standing;
}

RunningController::RunningController(Configuration configuration, Beginning beginning,
                                     Runtime& runtime, LogSink& log,
                                     const ControllerOptions& options,
                                     controller::ThreadMaker& threads)
    : configuration_{std::move(configuration)}, runtime_{runtime}, log_{log}, threads_{threads},
      takes_signals_{options.takes_signals}, greets_{options.greets},
      listening_{loop_, listeners_of(beginning.reading.config)}, has_terminal_{has_terminal()}
{
    Reading& reading = beginning.reading;
    ControllerConfig& config = reading.config;
    if (config.machine.program) {
        machine_.emplace(config, runtime_.medium(), clock_, log_, [this](bool is_in) {
            loop_.post([this, is_in] { machine_->medium_is(is_in); });
        });
    }
    refuse_beginning(beginning);
    if (reading.project != nullptr && config.labels.field != nullptr) {
        field_labels_.emplace(*config.labels.field, clock_, log_);
    } else if (reading.project != nullptr && runtime_.labels() == nullptr) {
        if (!runtime_.is_simulated()) {
            throw ConfigError{configuration_.project,
                              "found a project, and this PLC has no labels"};
        }
        labels_.emplace(config, clock_, threads_);
        labels_->tell_left_out(log_, config.labels.program_file);
    }
    if (beginning.last && beginning.last->project != nullptr) {
        expect(labels_check(reading.project, config, beginning.last->project_text())());
    }
#ifdef BUSBAR_KEY_LOG
    if (!config.key_log.empty()) {
        key_log_ = expect(net::KeyLogFile::open(config.key_log, log_), config.key_log);
    }
#endif
    standing_ = standing_of(config);
    make_missing_certificate(config, clock_.now(), machine_ ? machine_->log() : log_);
    listen(config, beginning.last ? beginning.last->listeners : Listening::Listeners{});
    listening_.set_in(config);
    runtime_use_.emplace(runtime_, static_cast<RuntimeHost&>(*this));
    current_ = std::make_unique<Generation>(configuration_, std::move(reading), surroundings(),
                                            requests());
    current_->prepare();
    current_->finish();
    clients_.use(current_->clients());
    identity_ = current_->config().server.identity;
    expect(listening_.listen()); // now that there is a server that answers
    register_with_discovery_server(current_->config());
}

void RunningController::refuse_beginning(const Beginning& beginning)
{
    const auto& [reading, last, refusal, damage] = beginning;
    if (refusal.empty() && damage.empty()) {
        return;
    }
    const std::string more = refusal.empty() || damage.empty() ? damage : "; " + damage;
    const std::string text =
        refusal.empty() ? damage : refusal + "; it begins with what it ran with last" + more;
    log_.write(LogLevel::Error, "controller", text);
    pending_.ask(PendingChanges::By::Start, text);
    refused_ = refusal + more;
}

/// Listens for clients, and connects to those that wait for a connection.
void RunningController::listen(const ControllerConfig& config, Listening::Listeners last)
{
    if (!config.machine.is_used) {
        return;
    }
    if (const auto begun = listening_.begin(); !begun) {
        if (last.empty() && !machine_) {
            throw ConfigError{begun.error()}; // it never served anybody, and no program goes on
        }
        const std::string why = text(begun.error());
        expect(listening_.begin_elsewhere(std::move(last)));
        if (listening_.is_halted() && machine_) {
            machine_->cannot_start(why);
        }
        const std::string what =
            why +
            (listening_.is_halted()
                 ? "; the server halts, and administrators reach it at this machine"
                 : "; it listens where it did last") +
            ", on port " + std::to_string(listening_.port()) + ", until it can";
        log_.write(LogLevel::Error, "controller", what);
        pending_.ask(PendingChanges::By::Listeners, what);
    }
    net::ReverseConnectConfig reverse;
    reverse.client_urls = config.reverse_urls;
    expect(loop_.connect_to_clients(reverse), "connecting to clients");
}

void RunningController::listen_as_told()
{
    const bool is_out =
        machine_ ? machine_->life().operating_status() == controller::OperatingStatus::Shutdown
                 : is_shut_down_;
    if (is_out || !listening_.can_go_as_told() || next_ != nullptr) {
        return;
    }
    try_to([&] {
        expect(listening_.go_as_told());
        replace({.cause = Machine::Cause::Restart,
                 .handover = {.reason = "it can listen where it is told to"},
                 .read = [this] { return reading_of_last(); }, // nothing else is taken up
                 .done =
                     [this] {
                         listening_.stay();
                         pending_.done(PendingChanges::By::Listeners);
                     },
                 .refused = [this](const ConfigError&) { listening_.go_back(); },
                 .is_of_last = true});
    });
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

std::shared_ptr<backend::LabelBackend> RunningController::labels() const
{
    if (field_labels_) {
        return field_labels_->labels();
    }
    return labels_ ? labels_->labels() : runtime_.labels();
}

Surroundings RunningController::surroundings()
{
    server::ServerEnvironment environment{
        .random = &random_, .wall_clock = &clock_, .waker = &loop_.waker()};
#ifdef BUSBAR_KEY_LOG
    environment.key_log = key_log_.get();
#endif
    return {.environment = environment,
            .lines = log_,
            .loop = loop_,
            .runtime = runtime_,
            .threads = threads_,
            .machine = machine_ ? &*machine_ : nullptr,
            .labels = labels(),
            .label_priority = labels_ ? labels_->task_priority() : 0,
            .port = listening_.port(),
            .pending = pending_,
            .is_shut_down = is_shut_down_};
}

Requests RunningController::requests()
{
    return {
        .stop = [this] { loop_.stop(); },
        .start_over =
            [this] {
                starts_again_ = true;
                loop_.stop();
            },
        .shut_down =
            [this](const std::string& reason) {
                is_shut_down_ = true;
                if (machine_) {
                    machine_->shut_server_down(reason);
                }
                loop_.unregister();
            },
        .restart = [this](const administration::RestartWish& wish) { restart(wish); },
        .renewed =
            [this] {
                renewed();
                changed(&controller::LifeCycle::certificate_renewed);
            },
        .security_changed = [this] { changed(&controller::LifeCycle::security_changed); },
        .address_changed = [this] { changed(&controller::LifeCycle::address_changed); },
        .hardware = [this](HardwareEvent event) { happen(event); },
        .memory_replaced =
            [this] {
                loop_.post([this] {
                    if (machine_->memory_replaced()) {
                        halt("the controller's memory was replaced, and it is to be restarted",
                             ServerState::Suspended);
                    }
                    looks_until_restart_ = 2; // the client is answered first
                });
            },
        .may_restart =
            [this] {
                // One that is out comes back with what it ran with last.
                return is_out()
                           ? std::function<Configured<void>()>{[] { return Configured<void>{}; }}
                           : restart_check();
            },
        .may_update = [this]() -> Configured<void> {
            try {
                static_cast<void>(reading_for_restart());
                return {};
            } catch (const ConfigError& error) {
                return Unexpected{error.problem()};
            }
        },
        .may_replace_own = [this] { return check_no_replacement("certificate"); },
        .check_listeners = [this](const ControllerConfig& next) { return check_listeners(next); },
        .settings_changed = [this] { loop_.post([this] { keep(); }); },
        .change_program = [this](const ProgramChange& change) { return change_program(change); }};
}

} // namespace busbar::product
