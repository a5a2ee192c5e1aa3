#include <memory>

#include "command_line/completion.hpp"
#include "commands.hpp"

namespace busbar::tool {

void add_completion(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("completion", "Prints a script for completion in a shell.");
    command->footer("For this shell: eval \"$(busbar completion bash)\"\n"
                    "It completes commands, options and their values, names of profiles, and, by\n"
                    "asking the server that the line names, nodes and values of enumerations.");
    const auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->callback([&run, shell] {
        run = [shell](Context& context) {
            context.out.write(command_line::completion_script("busbar", *shell));
            return Exit::Good;
        };
    });
}

} // namespace busbar::tool
