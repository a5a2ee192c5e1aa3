#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/net/worker_thread.hpp>
#ifdef BUSBAR_KEY_LOG
#include <busbar/net/key_log_file.hpp>
#endif
#include <busbar/server/password_users.hpp>

#include "administered.hpp"
#include "admission.hpp"
#include "config.hpp"
#include "default_config.hpp"
#include "hash_password.hpp"
#include "identity.hpp"
#include "live_config.hpp"
#include "plant.hpp"
#include "prints.hpp"
#include "reload.hpp"
#include "settings.hpp"
#include "startup.hpp"
#include "welcome.hpp"

using namespace busbar;
using example::ConfigError;
using example::ControllerConfig;

namespace {

template <typename T>
T expect(Result<T> result, const std::string& what)
{
    if (!result) {
        throw ConfigError{Problem{result.error(), what, "failed"}};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(result);
    }
}

int regenerate_certificate(ControllerConfig config)
{
    example::set_names(config);
    const server::ServerConfig& server = config.server;
    const auto made = example::regenerate_certificate(config.certificates, server.application_name,
                                                      server.application_uri, server.host_names,
                                                      net::SystemWallClock{}.now());
    std::printf("certificate: %s\nclients have to trust it anew; a controller that runs uses it "
                "after a restart\n",
                made.thumbprint_text().c_str());
    return 0;
}

void register_with_discovery_server(net::ServerLoop& loop, const ControllerConfig& config,
                                    const channel::ChannelEnvironment& environment)
{
    if (config.discovery.url.empty()) {
        return;
    }
    client::SecurityWishes wishes;
    wishes.min_mode = MessageSecurityMode::Sign;
    wishes.allows_none = config.discovery.allows_none;
    net::DiscoveryRegistrationConfig registration;
    registration.client =
        client::registration_client(config.discovery.url, wishes, config.server.application_uri,
                                    environment.identity != nullptr);
    registration.settings = net::registration_of(config.server, {config.server.endpoint_url});
    registration.settings.interval = config.discovery.interval;
    expect(loop.register_with(std::move(registration), environment),
           "registering with " + config.discovery.url);
}

bool has_terminal()
{
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    return terminal >= 0 && ::close(terminal) == 0;
}

/// What fails changes nothing: the reason goes to the log. A signal because the terminal was closed
/// ends the controller, as it does other programs in a terminal.
void reload_on_hangup(net::ServerLoop& loop, const std::string& file,
                      const example::ToAdminister& what, example::Administered& administered,
                      LogSink& log)
{
    loop.on_hangup([&, what, file, had_terminal = has_terminal()] {
        if (had_terminal && !has_terminal()) {
            loop.stop();
            return;
        }
        try {
            const DateTime now = net::SystemWallClock{}.now();
            log.write(LogLevel::Info, "controller",
                      example::reload(file, what.settings, what.admission, now));
            administered.read_users();
            what.server.announce_access_change(std::chrono::steady_clock::now());
        } catch (const ConfigError& error) {
            log.write(LogLevel::Error, "controller",
                      std::string{error.what()} + "; nothing was changed");
        }
    });
}

void print_statistics(const controller::PlcTask::Statistics& statistics)
{
    const auto microseconds = [](Duration time) {
        return static_cast<long long>(
            std::chrono::duration_cast<std::chrono::microseconds>(time).count());
    };
    std::printf("PLC task: %llu scans, %llu missed, begun at most %lld us late, at most %lld us "
                "long\n",
                static_cast<unsigned long long>(statistics.scans),
                static_cast<unsigned long long>(statistics.missed_cycles),
                microseconds(statistics.worst_lateness), microseconds(statistics.worst_scan));
}

/// A problem names `file`, where `config` is from; that is empty for the built-in one.
server::Server make_server(const server::ServerConfig& config,
                           const server::ServerEnvironment& environment, const std::string& file)
{
    return example::expect(
        server::Server::create(config, environment).map_error([&](Problem problem) {
            problem.where = (file.empty() ? "the server" : file) + ": " + problem.where;
            return problem;
        }));
}

void welcome(const ControllerConfig& config, const controller::Plc& plc,
             const example::Administered& administered, DateTime now)
{
    if (const auto& code = administered.new_code()) {
        std::printf("setup: log in as \"setup\" with the code %.*s, which is shown this once\n",
                    static_cast<int>(code->size()), code->text().data());
    }
    std::fputs(example::welcome_text(config, plc.variables().size(), now).c_str(), stdout);
    std::fflush(stdout);
}

void end(controller::PlcTask& task, example::Plant& plant, bool restarts)
{
    task.stop();
    plant.end();
    print_statistics(task.statistics());
    std::puts(restarts ? "starting again" : "stopped");
    std::fflush(stdout);
}

/// For clients that come, and those that wait to be connected to. The port.
std::uint16_t listen(net::ServerLoop& loop, const ControllerConfig& config, example::Plant& plant)
{
    const auto port = loop.listen(config.address, config.port);
    if (!port) {
        plant.cannot_start("it cannot listen on port " + std::to_string(config.port));
        throw ConfigError{Problem{port.error(), "listening", "failed"}};
    }
    net::ReverseConnectConfig reverse;
    reverse.client_urls = config.reverse_urls;
    expect(loop.connect_to_clients(reverse), "connecting to clients");
    return *port;
}

/// What the task does after each scan, on its thread. All must outlive it.
void follow_scans(controller::PlcTask& task, example::Plant& plant,
                  example::Administered& administered, LogSink& log)
{
    task.after_scan(
        [&plant, &administered](DateTime time) {
            plant.raise(time);
            if (plant.has_changed_files()) {
                administered.refresh_files();
            }
        },
        &log);
}

/// `file` is where `config` is from; empty for the built-in one. True if an administrator wants the
/// controller to start again.
bool serve(ControllerConfig config, example::Settings& settings, const std::string& file)
{
    net::StderrLog log{LogLevel::Debug};
    net::SystemWallClock wall_clock;
    crypto::SystemRandom random;
    net::ServerLoop loop{log};

    example::Plant plant{config, wall_clock, log};
    const std::uint16_t port = listen(loop, config, plant);
    example::set_names(config);
    example::set_endpoint(config, port, wall_clock.now());
    example::Administered administered{config, wall_clock, plant.log()};
    example::Admission admission{config, administered.log()};
    administered.add_users(admission, config);

    server::ServerEnvironment environment{.random = &random,
                                          .wall_clock = &wall_clock,
                                          .log = &administered.log(),
                                          .validator = &administered.clients(),
                                          .users = &admission.users(),
                                          .roles = &administered.roles(),
                                          .waker = &loop.waker()};
#ifdef BUSBAR_KEY_LOG
    std::unique_ptr<net::KeyLogFile> key_log;
    if (!config.key_log.empty()) {
        key_log = expect(net::KeyLogFile::open(config.key_log, log), config.key_log);
        environment.key_log = key_log.get();
    }
#endif
    register_with_discovery_server(
        loop, config,
        {.random = &random,
         .wall_clock = &wall_clock,
         .log = &log,
         .validator = environment.validator,
         .identity = config.server.identity ? &*config.server.identity : nullptr});
    auto server = make_server(config.server, environment, file);
    net::WorkerThread worker{64, &log};
    const example::LiveConfig live{server, administered, config, administered.log()};
    bool restarts = false;
    const example::ToAdminister what{.server = server,
                                     .admission = admission,
                                     .config = config,
                                     .settings = settings,
                                     .worker = worker,
                                     .stop = [&loop] { loop.stop(); },
                                     .restart =
                                         [&loop, &restarts] {
                                             restarts = true;
                                             loop.stop();
                                         },
                                     .offer_changed = [&] { live.apply(settings.config()); },
                                     .file_systems = plant.file_systems()};
    administered.attach(what);
    settings.run({.check = [&](const ControllerConfig& next) { return live.check(next); },
                  .apply = [&](const ControllerConfig& next) { live.apply(next); }});
    plant.publish(server, log);

    admission.check_passwords_on(worker);
    controller::PlcTask task{plant.plc(), wall_clock, config.scan, config.realtime_priority};
    follow_scans(task, plant, administered, log);
    task.start();
    loop.stop_on_signals();
    reload_on_hangup(loop, file, what, administered, log);
    welcome(config, plant.plc(), administered, wall_clock.now());
    plant.run(config.server.endpoint_url);
    loop.run(server);
    end(task, plant, restarts);
    return restarts;
}

/// What the command line says instead of the configuration.
struct Overrides {
    std::optional<std::uint16_t> port;
    std::string preset;
};

/// From the configuration as it is now until the end. True if it is to start again.
bool start(const std::string& file, const Overrides& overrides)
{
    example::Settings settings{file, overrides.preset};
    ControllerConfig config = settings.config();
    config.port = overrides.port.value_or(config.port);
    if (file.empty()) {
        example::add_first_account(config);
    } else if (example::is_nobody(config.users) && !config.users.has_setup) {
        throw ConfigError{file, "nobody can log in, expected an account, anonymous, "
                                "certificates or tokens in [users]: see --print-config"};
    }
    try {
        return serve(std::move(config), settings, file);
    } catch (const ConfigError& error) {
        // An address that is not this machine's, a model that is not there any more.
        if (settings.list().changes().empty()) {
            throw;
        }
        throw ConfigError{error.what(),
                          "settings were changed online, --forget-changes drops what was"};
    }
}

constexpr int usage_exit = 2;

/// 0 for --help.
int end_early(const CLI::App& app, const CLI::ParseError& error)
{
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
        return app.exit(error);
    }
    const std::vector<std::string> unknown = app.remaining();
    if (unknown.empty()) {
        std::fprintf(stderr, "busbar-controller: %s\n", error.what());
    } else {
        std::fprintf(stderr, "busbar-controller: %s: not expected here\n", unknown.front().c_str());
    }
    const bool is_file = !unknown.empty() && !unknown.front().starts_with('-');
    std::fprintf(stderr, "  hint: %s%s\n",
                 is_file ? "busbar-controller --config " : "busbar-controller --help",
                 is_file ? unknown.front().c_str() : "");
    return usage_exit;
}

int run(int argc, char** argv)
{
    std::string file;
    Overrides overrides;
    bool wants_hash = false;
    bool wants_config = false;
    bool wants_certificate = false;
    bool forgets_changes = false;
    example::Prints prints;
    CLI::App app{
        "An OPC UA server in front of a simulated PLC. SIGHUP has it read users, trust lists, "
        "endpoints and limits again."};
    app.add_option("--config", file, "configuration; the built-in one by default");
    app.add_option("--port", overrides.port,
                   "instead of the configuration's; 0 is any that is free");
    app.add_option("--preset", overrides.preset,
                   "the limits of a product instead of the configuration's: nj501, nx102 or "
                   "rd81opc96")
        ->type_name("NAME");
    app.add_flag("--print-config", wants_config, "print the built-in configuration, commented");
    app.add_flag("--hash-password", wants_hash,
                 "read a password from standard input, print what a configuration may store");
    app.add_flag("--regenerate-certificate", wants_certificate,
                 "make a new certificate and key with the names of the configuration, and end");
    app.add_flag("--forget-changes", forgets_changes,
                 "drop what administrators changed of the settings online, and end");
    prints.add_to(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return end_early(app, error);
    }
    if (wants_config) {
        std::fputs(example::default_config, stdout);
        return 0;
    }
    if (wants_hash) {
        return example::hash_password();
    }
    if (const auto end = prints.run(file)) {
        return *end;
    }
    // Messages of some 100 kB come and go all the time: keep their pages.
    ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
    // Who reads the log may go; the machine goes on.
    std::signal(SIGPIPE, SIG_IGN);
    if (forgets_changes) {
        example::forget_changes(file);
        return 0;
    }
    if (wants_certificate) {
        return regenerate_certificate(example::Settings{file, overrides.preset}.config());
    }
    bool starts = true;
    while (starts) {
        starts = start(file, overrides);
    }
    return 0;
}

} // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-controller: %s\n", error.what());
        return 1;
    }
}
