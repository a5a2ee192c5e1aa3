#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "command_line/program_options.hpp"
#include "experiment.hpp"

using namespace busbar;

int main(int argc, char** argv)
{
    timing::Settings settings;
    std::string only;
    CLI::App app{"Looks for a difference in time between the refusals that RSA has a part in: what "
                 "cannot be told apart tells an attacker nothing. Prints, and asserts nothing."};
    app.add_option("--samples", settings.samples, "of each class")
        ->check(CLI::Range(10, 10'000'000))
        ->capture_default_str();
    app.add_option("--seed", settings.seed, "of the order")->capture_default_str();
    app.add_option("--policy", only, "one policy instead of all");
    command_line::add_program_options(app, "busbar-timing");
    CLI11_PARSE(app, argc, argv);

    std::size_t told_apart = 0;
    for (const auto& policy : crypto::security_policies().subspan(1)) {
        const std::string name{policy.name};
        if (!only.empty() && only != name) {
            continue;
        }
        told_apart +=
            timing::run("OpenSecureChannel, " + name, timing::open_attempts(policy), settings);
        told_apart +=
            timing::run("user name token, " + name, timing::token_attempts(policy), settings);
    }
    std::printf("\n%zu can be told apart\n", told_apart);
    return 0;
}
