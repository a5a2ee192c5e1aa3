#include <memory>

#include "commands.hpp"
#include "tool/connection/usage.hpp"

// The scripts are made from the commands and options that the program has, so that they cannot
// fall behind it.
namespace busbar::tool {

namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app)
{
    return app.get_subcommands(
        [](const CLI::App* command) { return !command->get_name().empty(); });
}

std::string spaced(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : " ") + word;
    }
    return text;
}

std::string words_of(const CLI::App& app)
{
    std::vector<std::string> words;
    for (const CLI::App* command : commands_of(app)) {
        words.push_back(command->get_name());
    }
    for (std::string& option : options_of(app)) {
        words.push_back(std::move(option));
    }
    return spaced(words);
}

/// A branch for each command, "cert" and "cert list" alike.
void append_bash_branches(const CLI::App& app, const std::string& prefix, std::string& script)
{
    for (const CLI::App* command : commands_of(app)) {
        const std::string name = prefix + command->get_name();
        script += "    '" + name + "') words='" + words_of(*command) + "' ;;\n";
        append_bash_branches(*command, name + " ", script);
    }
}

std::string bash_script(const CLI::App& app)
{
    std::string names;
    for (const CLI::App* command : commands_of(app)) {
        names += (names.empty() ? "" : "|") + command->get_name();
        for (const CLI::App* below : commands_of(*command)) {
            names += "|" + below->get_name();
        }
    }
    std::string script = "_busbar() {\n"
                         "  local word words command=''\n"
                         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
                         "    case \"$word\" in " +
                         names +
                         ") command=\"${command:+$command }$word\" ;; esac\n"
                         "  done\n"
                         "  case \"$command\" in\n";
    append_bash_branches(app, "", script);
    return script + "    *) words='" + words_of(app) +
           "' ;;\n"
           "  esac\n"
           "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
           "}\n"
           "complete -o default -F _busbar busbar\n";
}

std::string zsh_script(const CLI::App& app)
{
    return "autoload -U +X bashcompinit && bashcompinit\n" + bash_script(app);
}

/// In single quotes, as fish reads it.
std::string quoted(const std::string& text)
{
    std::string result{"'"};
    for (const char character : text) {
        result += character == '\'' || character == '\\' ? std::string{'\\', character}
                                                         : std::string{character};
    }
    return result + "'";
}

void append_fish(const CLI::App& app, const std::string& condition, std::string& script)
{
    std::vector<std::string> names;
    for (const CLI::App* command : commands_of(app)) {
        names.push_back(command->get_name());
    }
    for (const CLI::App* command : commands_of(app)) {
        script += "complete -c busbar -n '" + condition +
                  (names.empty() ? "" : "; and not __fish_seen_subcommand_from " + spaced(names)) +
                  "' -f -a " + command->get_name() + " -d " + quoted(command->get_description()) +
                  "\n";
        append_fish(*command,
                    (condition == "true" ? "" : condition + "; and ") +
                        "__fish_seen_subcommand_from " + command->get_name(),
                    script);
    }
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            script += "complete -c busbar -n '" + condition + "' -l " + name + " -d " +
                      quoted(option->get_description()) + "\n";
        }
    }
}

std::string fish_script(const CLI::App& app)
{
    std::string script;
    append_fish(app, "true", script);
    return script;
}

} // namespace

void add_completion(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("completion", "Prints a script for completion in a shell.");
    command->footer("For this shell: eval \"$(busbar completion bash)\"");
    const auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->callback([&app, &run, shell] {
        run = [&app, shell](Context& context) {
            context.out.write(*shell == "bash"  ? bash_script(app)
                              : *shell == "zsh" ? zsh_script(app)
                                                : fish_script(app));
            return Exit::Good;
        };
    });
}

} // namespace busbar::tool
