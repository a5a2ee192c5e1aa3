#include <busbar/product/program.hpp>

#include <csignal>
#include <cstdio>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include <busbar/net/system.hpp>
#include <busbar/product/controller.hpp>

#include "command_line/program_options.hpp"
#include "product/access/identity.hpp"
#include "product/access/setup.hpp"
#include "product/configuration/config.hpp"
#include "product/configuration/default_config.hpp"
#include "product/configuration/reading.hpp"
#include "product/configuration/settings.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/machine/simulated_runtime.hpp"
#include "product/printing/prints.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

int regenerate_certificate(ControllerConfig config)
{
    set_names(config);
    const server::ServerConfig& server = config.server;
    const auto made =
        regenerate_certificate(config.certificates, server.application_name, server.application_uri,
                               server.host_names, net::SystemWallClock{}.now());
    std::printf("certificate: %s\nclients must trust the new certificate; a running controller "
                "uses it after a restart\n",
                made.thumbprint_text().c_str());
    return 0;
}

constexpr int usage_exit = 2;

/// 0 for --help and --version.
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

int run(int argc, char** argv, Runtime& runtime)
{
    Configuration configuration;
    bool wants_hash = false;
    bool wants_config = false;
    bool wants_certificate = false;
    bool forgets_changes = false;
    Prints prints;
    CLI::App app{
        "An OPC UA server in front of a PLC: a simulated one, or PLCs with Modbus TCP or SLMP. On "
        "SIGHUP it reads users, trust lists, endpoints and limits again, and takes over a changed "
        "program of [machine]. SIGTERM ends it."};
    app.add_option("--config", configuration.file, "configuration; the built-in one by default");
    app.add_option("--port", configuration.port,
                   "instead of the configuration's; 0 is any that is free");
    app.add_option("--preset", configuration.preset,
                   "the limits of a product instead of the configuration's: nj501, nx102 or "
                   "rd81opc96")
        ->type_name("NAME");
    app.add_option(
           "--project", configuration.project,
           "the folder of a project of model mode, which `busbar project write` puts there; "
           "it says network, users, security and information models")
        ->type_name("FOLDER");
    app.add_flag("--print-config", wants_config, "print the built-in configuration, commented");
    app.add_flag("--hash-password", wants_hash,
                 "read a password from standard input, print what a configuration may store, "
                 "hashed as [users] of --config says");
    app.add_flag("--regenerate-certificate", wants_certificate,
                 "make a new certificate and key with the names of the configuration, and end");
    app.add_flag("--forget-changes", forgets_changes,
                 "drop what was changed online, settings and a program that was sent, and end");
    prints.add_to(app);
    command_line::add_program_options(app, "busbar-controller");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return end_early(app, error);
    }
    if (wants_config) {
        std::fputs(default_config, stdout);
        return 0;
    }
    if (wants_hash) {
        return hash_password(configuration.file);
    }
    if (const auto end = prints.run(configuration)) {
        return *end;
    }
    // The reader of the log may exit; the machine continues.
    std::signal(SIGPIPE, SIG_IGN);
    if (forgets_changes) {
        const auto forgotten = forget_changes(configuration.file);
        for (const std::string& each : forgotten) {
            std::printf("forgot %s\n", each.c_str());
        }
        if (forgotten.empty()) {
            std::puts("nothing was changed online");
        }
        return 0;
    }
    if (wants_certificate) {
        return regenerate_certificate(read_sources(configuration).config);
    }
    expect(expect(Controller::create(std::move(configuration), runtime))->run());
    return 0;
}

} // namespace

int run_program(int argc, char** argv)
{
    SimulatedRuntime runtime;
    return run_program(argc, argv, runtime);
}

int run_program(int argc, char** argv, Runtime& runtime)
{
    try {
        return run(argc, argv, runtime);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-controller: %s\n", error.what());
        return 1;
    }
}

} // namespace busbar::product
