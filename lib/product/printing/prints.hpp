#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <busbar/net/system.hpp>

#include "describe.hpp"
#include "product/configuration/presets.hpp"
#include "product/configuration/reading.hpp"

namespace busbar::product {

/// The options that print a part of the configuration and end the program.
struct Prints {
    void add_to(CLI::App& app)
    {
        const auto add = [&](const char* name, std::string& file, const char* text) {
            return app.add_option(name, file, text)->expected(0, 1)->type_name("[FILE]");
        };
        limits = add("--print-limits", limits_file,
                     "print all limits, of a configuration if it is given, and the memory that "
                     "clients can make the controller hold by them");
        capacities = add("--print-capacities", capacities_file,
                         "print how much it can do at most, of a configuration if it is given");
        conformance = add("--print-conformance", conformance_file,
                          "print which profiles of OPC UA are claimed, of a configuration if it is "
                          "given, and what is missing for the others");
        app.add_option("--print-preset", preset,
                       "print the limits of a product as JSON: nj501, nx102 or rd81opc96")
            ->type_name("NAME");
        explanation =
            app.add_option("--explain", explained,
                           "print the value of a key of the configuration, where it comes from, "
                           "what it would be otherwise and when a change takes effect; without a "
                           "key or for \"all\", print a line for each")
                ->expected(0, 1)
                ->type_name("[KEY]");
        check = app.add_option("--check", checked,
                               "print what of a program would be published, and why the rest would "
                               "not; without a file for the program of the configuration, and what "
                               "the PLCs of its backends answer")
                    ->expected(0, -1)
                    ->type_name("[FILE...]");
        app.add_flag("--json", wants_json, "with --print-conformance or --check, as JSON");
    }
    /// Runs the chosen option and returns the exit code; nothing if none is chosen. `configuration`
    /// comes from the rest of the command line.
    [[nodiscard]] std::optional<int> run(const Configuration& configuration) const
    {
        const std::string& file = configuration.file;
        const auto of = [&](const std::string& own) { return own.empty() ? file : own; };
        if (limits->count() != 0) {
            return print_limits(of(limits_file));
        }
        if (capacities->count() != 0) {
            return print_capacities(of(capacities_file));
        }
        if (conformance->count() != 0) {
            return print_conformance(of(conformance_file), wants_json, net::SystemWallClock{}.now(),
                                     net::is_clock_synchronized());
        }
        if (wants_json && check->count() == 0 && conformance->count() == 0) {
            throw ConfigError{"--json", "expected --print-conformance or --check with it"};
        }
        if (check->count() != 0) {
            ControllerConfig config = read_config_or_default(file);
            if (const Preset* const chosen = find_preset(configuration.preset)) {
                chosen->take(config);
            }
            return product::check(config, checked, wants_json);
        }
        if (explanation->count() != 0) {
            return print_explanation(configuration, explained);
        }
        return preset.empty() ? std::nullopt : std::optional{print_preset(preset)};
    }

    CLI::Option* limits{nullptr};
    CLI::Option* capacities{nullptr};
    CLI::Option* conformance{nullptr};
    CLI::Option* explanation{nullptr};
    CLI::Option* check{nullptr};
    std::vector<std::string> checked;
    std::string preset;
    std::string explained;
    std::string limits_file;
    std::string capacities_file;
    std::string conformance_file;
    bool wants_json{false};
};

} // namespace busbar::product
