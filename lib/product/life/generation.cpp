#include "generation.hpp"

#include <chrono>
#include <cstdio>
#include <ctime>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/server/running_server.hpp>

#include "product/configuration/live_config.hpp"
#include "product/model/models.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

LogSink& log_of(const Surroundings& around)
{
    return around.machine != nullptr ? around.machine->log() : around.lines;
}

ControllerConfig complete(ControllerConfig config, const Surroundings& around)
{
    set_names(config);
    set_endpoint(config, around.port, around.environment.wall_clock->now(), log_of(around));
    return config;
}

/// In minutes.
std::int32_t local_utc_offset(DateTime now)
{
    const std::time_t seconds = now.unix_seconds();
    std::tm local{};
    return ::localtime_r(&seconds, &local) != nullptr
               ? static_cast<std::int32_t>(local.tm_gmtoff / 60)
               : 0;
}

/// Only a restart lets a server in again that is out (W588, 4-1-2; SH-082679, 9.13).
Configured<void> check_run(const Surroundings& around)
{
    const std::string why = around.machine != nullptr ? around.machine->why_out()
                            : around.is_shut_down     ? "an administrator shut it down"
                                                      : "";
    return why.empty() ? Configured<void>{}
                       : misconfigured("the OPC UA server",
                                       "found that " + why +
                                           ", expected a restart first: busbar admin shutdown "
                                           "--restart, or a start of the controller",
                                       status::Bad_InvalidState);
}

/// Returns the function to call after each scan, on the thread that scans. All arguments must
/// outlive it.
std::function<void(DateTime)> following_scans(const Plant& plant, Administered& administered,
                                              Machine* machine)
{
    return [&plant, &administered, machine](DateTime time) {
        plant.raise(time);
        if (machine != nullptr && machine->has_changed_files()) {
            administered.refresh_files();
        }
    };
}

} // namespace

Generation::Generation(const Configuration& configuration, Reading reading,
                       const Surroundings& around, const Requests& requests)
    : configuration_{configuration}, around_{around}, security_changed_{requests.security_changed},
      hardware_{requests.hardware}, settings_{std::move(reading.settings)},
      config_{complete(std::move(reading.config), around)}, plant_{config_, around.runtime},
      devices_{config_.backends, *around.environment.wall_clock, around.lines},
      project_{std::move(reading.project)}, administered_{config_, settings_->files(),
                                                          *around.environment.wall_clock,
                                                          log_of(around)},
      admission_{config_, settings_->files(), administered_.log()}, server_{make_server()},
      worker_{64, &around.lines}, channel_worker_{64, &around.lines}, live_{server_, administered_,
                                                                            config_,
                                                                            administered_.log()},
      lookout_{server_,
               manages_certificates(config_) ? &admission_.client_store() : nullptr,
               *around.environment.wall_clock,
               administered_.log(),
               [this] { return present_hosts(config_); },
               requests.address_changed}
{
    attach(requests);
}

void Generation::finish()
{
    admission_.check_passwords_on(worker_);
    if (!config_.labels.has_plc()) {
        after_scan_ = following_scans(plant_, administered_, around_.machine);
        task_.emplace(plant_.plc(), *around_.environment.wall_clock, config_.scan,
                      config_.realtime_priority, &around_.threads);
        task_->after_scan(after_scan_, &around_.lines);
    }
}

void Generation::prepare()
{
    plant_.publish(server_, settings_->sources(), around_.lines,
                   around_.machine != nullptr ? &around_.machine->event_log() : nullptr, hardware_);
    if (around_.machine != nullptr) {
        plant_.keep_writes(around_.machine->retained());
    }
    plant_.load();
    devices_.publish(server_);
    if (project_ == nullptr) {
        return;
    }
    const auto published = project_->publish(server_, BUSBAR_VERSION, administered_.log());
    if (project_->project() != nullptr) {
        const WallClock& clock = *around_.environment.wall_clock;
        mapped_.emplace(MappedModel::Needs{
            .server = server_,
            .mapping = published.mapping,
            .project = *project_->project(),
            .labels = around_.labels,
            .utc_offset_minutes = config_.labels.utc_offset.value_or(local_utc_offset(clock.now())),
            .isolates_failures = config_.labels.isolates_failures,
            .call_limit = config_.labels.call_limit,
            .clock = clock,
            .log = administered_.log(),
            .module = published.module});
    }
}

void Generation::start()
{
    tell_found_certificates();
    if (config_.machine.program != nullptr) {
        around_.runtime.mode_changed(config_.machine.mode);
    }
    if (task_) {
        has_own_task_ = plant_.loaded().start([this](DateTime now, Duration elapsed) {
            plant_.plc().scan(now, elapsed);
            busbar::detail::guarded(around_.lines, "after a scan", [&] { after_scan_(now); });
        });
        if (!has_own_task_) {
            task_->start();
        }
    }
    if (mapped_) {
        mapped_->start();
    }
    devices_.start(around_.loop);
}

void Generation::halt()
{
    tell_found_certificates();
    devices_.stop();
    if (mapped_) {
        mapped_->stop();
    }
    if (std::exchange(has_own_task_, false)) {
        plant_.loaded().stop();
        plant_.plc().halt();
    } else if (task_) {
        task_->stop();
    }
}

void Generation::look()
{
    lookout_.look();
    tell_found_certificates();
}

/// Another generation accepts the folders as they are.
void Generation::tell_found_certificates()
{
    admission_.tell_found_certificates(around_.environment.wall_clock->now());
}

/// Creates the server; a problem names the configuration's file.
server::Server Generation::make_server()
{
    administered_.add_users(admission_, config_);
    server::ServerEnvironment environment = around_.environment;
    environment.log = &administered_.log();
    environment.validator = &administered_.clients();
    environment.users = &admission_.users();
    environment.roles = &administered_.roles();
    environment.channel_worker = &channel_worker_; // of which it makes no use before it is served
    return expect(server::Server::create(config_.server, environment)
                      .transform_error([this](Problem problem) {
                          problem.where =
                              (configuration_.file.empty() ? "the server" : configuration_.file) +
                              ": " + problem.where;
                          return problem;
                      }));
}

void Generation::attach(const Requests& requests)
{
    const bool goes_on = around_.machine != nullptr || project_ != nullptr;
    const auto files = around_.machine != nullptr ? around_.machine->file_systems()
                                                  : std::vector<administration::FileSystem>{};
    administered_.attach(
        {.server = server_,
         .admission = admission_,
         .config = config_,
         .settings = *settings_,
         .worker = worker_,
         .stop = requests.stop,
         .start_over = requests.start_over,
         .shut_down = goes_on ? requests.shut_down : nullptr,
         .may_run = [this] { return check_run(around_); },
         .restart = requests.restart,
         .may_restart = requests.may_restart,
         .may_replace_own = requests.may_replace_own,
         .is_in_run =
             [machine = around_.machine] {
                 return machine != nullptr && machine->mode() == controller::MachineMode::Run;
             },
         .users_changed = requests.security_changed,
         .offer_changed = [this] { live_.apply_offer(settings_->config()); },
         .renewed = requests.renewed,
         .file_systems = files,
         .file_transfers = transfers(requests),
         .status = status_facts({server_, config_, *settings_, around_.machine, around_.pending,
                                 around_.is_shut_down, goes_on})});
    settings_->run(
        {.check =
             [this, listeners = requests.check_listeners](const ControllerConfig& next) {
                 return live_.check(next).and_then([&] { return listeners(next); }).and_then([&] {
                     return check_models(next);
                 });
             },
         .apply =
             [this, changed = requests.settings_changed](const ControllerConfig& next) {
                 // The changes are stored: what fails now is told, and takes effect at a start.
                 LogSink& log = log_of(around_);
                 administered_.audit().set_changing_settings(settings_->is_applying() &&
                                                             !is_switching_mode_);
                 busbar::detail::guarded(log, "settings", [&] { apply(next); });
                 administered_.audit().set_changing_settings(false);
                 busbar::detail::guarded(log, "settings", changed);
             },
         .security_changed =
             [this] {
                 busbar::detail::guarded(log_of(around_), "settings", [&] { security_changed(); });
             }});
}

/// Bypasses the audit, which already has a record with the user.
void Generation::security_changed()
{
    const RecordField fields[] = {{"IsSecurity", Variant{true}}};
    Record record{RecordKind::SettingsChanged, LogLevel::Info, "settings"};
    record.fields = fields;
    tell(log_of(around_), record);
    security_changed_();
}

Configured<void> Generation::check_models(const ControllerConfig& next) const
{
    if (next.nodesets == config_.nodesets && next.nodesets_strict == config_.nodesets_strict) {
        return {};
    }
    try {
        NullLog no_log;
        server::ServerEnvironment environment = around_.environment;
        environment.log = &no_log;
        server::ServerConfig config;
        config.endpoints.clear();
        config.endpoints.emplace_back().allows_anonymous = true;
        auto scratch = expect(server::Server::create(config, environment));
        SourceFiles sources;
        load_models(scratch, next, sources, no_log);
        return {};
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

void Generation::apply(const ControllerConfig& next)
{
    live_.apply(next);
    if (next.users.anonymous != admission_.user_config().anonymous) {
        admission_.let_anonymous_in(next.users.anonymous);
        static_cast<void>(
            server::RunningServer{server_}.end_sessions([](const server::UserIdentity& user) {
                return user.token_type == UserTokenType::Anonymous;
            }));
    }
    if (around_.machine != nullptr && next.machine.mode != config_.machine.mode) {
        config_.machine.mode = next.machine.mode;
        around_.machine->change_mode(next.machine.mode);
        plant_.program()->show_mode(server_, next.machine.mode);
        around_.runtime.mode_changed(next.machine.mode);
        administered_.log().write(
            LogLevel::Info, "controller",
            std::string{"the machine is in "} +
                (next.machine.mode == controller::MachineMode::Run ? "RUN" : "PROGRAM"));
    }
}

std::vector<std::optional<StorageEntry::Version>> Generation::kept_versions() const
{
    std::vector<std::optional<StorageEntry::Version>> all;
    for (const char* const name : {Settings::file_name, Administered::users_file,
                                   Administered::roles_file, Setup::code_file}) {
        const auto entry = settings_->folder().entry(name);
        all.push_back(entry ? std::optional{entry->version} : std::nullopt);
    }
    if (project_ != nullptr) {
        all.push_back(project_->version());
    }
    return all;
}

TakenOver Generation::taken_over() const
{
    TakenOver all;
    all.files = settings_->sources().texts();
    if (!settings_->waits_for_restart()) {
        all.settings = administration::settings_document(settings_->list().changes(),
                                                         settings_->list().authors());
    }
    all.project = project_ != nullptr ? project_->shared_document() : nullptr;
    return all;
}

void Generation::print_welcome()
{
    if (const auto& code = administered_.new_code()) {
        std::printf("setup: log in as \"setup\" with the code %.*s, which is shown this once\n",
                    static_cast<int>(code->size()), code->text().data());
    } else if (administered_.is_in_setup()) {
        std::printf("setup: log in as \"setup\" by the code that an earlier start has shown; if it "
                    "is lost, stop, remove %s and start again\n",
                    administered_.code_place().c_str());
    }
    if (administered_.is_in_setup()) {
        std::fputs(setup_text(config_.server.endpoint_url).c_str(), stdout);
    } else if (administered_.is_waiting_for_port()) {
        std::puts(
            "setup: there is no administrator, and no port by which one could be made; a start "
            "with use = true in [machine] shows a code for it");
    }
    std::optional<int> priority = task_ ? task_->realtime_priority() : around_.label_priority;
    if (has_own_task_) {
        priority.reset();
    }
    const std::string text = welcome_text(
        config_, (mapped_ ? mapped_->variables() : plant_.visible_variables()) + devices_.size(),
        around_.environment.wall_clock->now(), priority);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
    administered_.code_is_shown();
}

void Generation::print_statistics() const
{
    if (!task_ || task_->statistics().scans == 0) {
        return;
    }
    const auto microseconds = [](Duration time) {
        return static_cast<long long>(
            std::chrono::duration_cast<std::chrono::microseconds>(time).count());
    };
    const controller::PlcTask::Statistics statistics = task_->statistics();
    std::printf("PLC task: %llu scans, %llu missed, begun at most %lld us late, at most %lld us "
                "long\n",
                static_cast<unsigned long long>(statistics.scans),
                static_cast<unsigned long long>(statistics.missed_cycles),
                microseconds(statistics.worst_lateness), microseconds(statistics.worst_scan));
}

std::string Generation::reload()
{
    const std::vector<Account> before = admission_.user_config().accounts;
    std::string found = product::reload(configuration_.file, *settings_, admission_,
                                        around_.environment.wall_clock->now());
    const char* separator = "; changed online, and used instead of the file: ";
    for (const std::string& name : settings_->overruled()) {
        found += separator + name;
        separator = ", ";
    }
    administered_.read_users();
    if (admission_.user_config().accounts != before) {
        security_changed();
    }
    server_.announce_access_change(std::chrono::steady_clock::now());
    return found;
}

} // namespace busbar::product
