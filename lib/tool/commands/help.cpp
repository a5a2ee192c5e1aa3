#include <memory>

#include "commands.hpp"
#include "tool/connection/failure.hpp"

namespace busbar::tool {

namespace {

/// The help of the command that the words name, "admin trust add"; throws Failure if there is none.
std::string help_of(CLI::App& app, const std::vector<std::string>& words)
{
    CLI::App* command = &app;
    std::string name = app.get_name();
    for (const std::string& word : words) {
        const auto found = command->get_subcommands(
            [&](const CLI::App* each) { return each->get_name() == word; });
        if (found.empty()) {
            throw unknown_command(*command, word);
        }
        command = found.front();
        name += " " + word;
    }
    return command->get_formatter()->make_help(command, name, CLI::AppFormatMode::Normal);
}

} // namespace

void add_help(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("help", "Tells more of a command, as its --help does.");
    const auto words = std::make_shared<std::vector<std::string>>();
    command->add_option("COMMAND", *words, "a command, and one of its own; none for all");
    when_chosen(*command, run, [&app, words](Context& context) {
        context.out.write(help_of(app, *words));
        return Exit::Good;
    });
}

} // namespace busbar::tool
