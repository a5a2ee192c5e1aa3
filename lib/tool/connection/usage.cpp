#include "failure.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "context.hpp"
#include "core/nearest.hpp"

namespace busbar::tool {

namespace {

/// The innermost command that was recognised.
const CLI::App& command_of(const CLI::App& app)
{
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
    }
    return *command;
}

std::string full_name(const CLI::App& command)
{
    const CLI::App* const parent = command.get_parent();
    return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

std::vector<std::string> commands_below(const CLI::App& level)
{
    std::vector<std::string> names;
    for (const CLI::App* command : level.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

Failure unknown_option(const CLI::App& command, const std::string& word)
{
    const std::string name = word.substr(0, word.find('='));
    const std::string meant = nearest(name, options_of(command));
    return {Exit::Usage, name + ": not an option of `" + full_name(command) + "`",
            meant.empty() ? "`" + full_name(command) +
                                " --help` has its options; text that begins "
                                "with - must come after --"
                          : "did you mean " + meant + "?"};
}

} // namespace

Failure unknown_command(const CLI::App& level, const std::string& word)
{
    const std::vector<std::string> commands = commands_below(level);
    const std::string name = full_name(level);
    if (const std::string meant = nearest(word, commands); !meant.empty()) {
        return {Exit::Usage, word + ": not a command",
                "did you mean `" + name + " " + meant + "`?"};
    }
    if (is_url(word) || word.starts_with('@')) {
        return {Exit::Usage, word + ": a command must come first",
                "`" + name + " browse " + word + "` shows what the server has"};
    }
    return {Exit::Usage, word + ": not a command", "there are " + joined(commands)};
}

std::string joined(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : ", ") + word;
    }
    return text;
}

std::vector<std::string> options_of(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::App* level = &app; level != nullptr; level = level->get_parent()) {
        const auto listed = level->get_options(
            [](const CLI::Option* option) { return !option->get_group().empty(); });
        for (const CLI::Option* option : listed) {
            for (const std::string& name : option->get_lnames()) {
                if (std::find(names.begin(), names.end(), "--" + name) == names.end()) {
                    names.push_back("--" + name);
                }
            }
        }
    }
    return names;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates)
{
    const auto found = busbar::detail::nearest(word, candidates);
    return found.empty() ? std::string{} : found.front();
}

Failure usage_failure(const CLI::App& app, const CLI::ParseError& error)
{
    const CLI::App& command = command_of(app);
    const std::vector<std::string> unknown = app.remaining(true);
    const bool lacks_command =
        command.get_require_subcommand_min() > 0 && command.get_subcommands().empty();
    const std::string help = "`" + full_name(command) + " --help` tells more";
    for (const std::string& word : unknown) {
        if (word.starts_with('-')) {
            return unknown_option(command, word);
        }
        if (lacks_command) {
            return unknown_command(command, word);
        }
    }
    if (lacks_command) {
        return {Exit::Usage, full_name(command) + ": no command is given",
                "there are " + joined(commands_below(command))};
    }
    if (!unknown.empty()) {
        return {Exit::Usage, unknown.front() + ": one argument too many", help};
    }
    return {Exit::Usage, error.what(), help};
}

} // namespace busbar::tool
