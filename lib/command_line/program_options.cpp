#include "program_options.hpp"

#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/core/version.hpp>

#include "manual_page.hpp"

namespace busbar::command_line {

namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app)
{
    return app.get_subcommands(
        [](const CLI::App* command) { return !command->get_name().empty(); });
}

/// Lists the options that --help shows.
std::vector<const CLI::Option*> options_of(const CLI::App& app, bool is_positional)
{
    return app.get_options([is_positional](const CLI::Option* option) {
        return !option->get_group().empty() && option->get_positional() == is_positional;
    });
}

bool is_repeated(const CLI::Option& option)
{
    return option.get_expected_max() > 1;
}

/// Writes an option as "--config FILE" or "-a, --attribute NAME".
std::string name_of(const CLI::Option& option, bool is_positional)
{
    std::string name = option.get_name(is_positional, !is_positional);
    for (std::size_t at = name.find(','); at != std::string::npos; at = name.find(',', at + 2)) {
        name.insert(at + 1, " ");
    }
    if (!is_positional && option.get_type_size() != 0 && !option.get_type_name().empty()) {
        name += " " + option.get_type_name();
    }
    return name + (is_repeated(option) ? "..." : "");
}

std::string text_of(const CLI::Option& option)
{
    std::string text = option.get_description();
    if (!option.get_default_str().empty()) {
        text += (text.empty() ? "default: " : "; default: ") + option.get_default_str();
    }
    return text;
}

std::string arguments_of(const CLI::App& app)
{
    std::string text = options_of(app, false).empty() ? "" : "[OPTIONS]";
    for (const CLI::Option* option : options_of(app, true)) {
        const std::string name = name_of(*option, true);
        text += option->get_required() ? " " + name : " [" + name + "]";
    }
    if (!commands_of(app).empty()) {
        text += app.get_require_subcommand_min() > 0 ? " COMMAND" : " [COMMAND]";
    }
    return text;
}

std::vector<ManualPage::Entry> entries_of(const CLI::App& app)
{
    std::vector<ManualPage::Entry> entries;
    for (const bool is_positional : {true, false}) {
        for (const CLI::Option* option : options_of(app, is_positional)) {
            // Skip the help option of commands, since every command has it.
            if (app.get_parent() == nullptr || option != app.get_help_ptr()) {
                entries.push_back({name_of(*option, is_positional), text_of(*option)});
            }
        }
    }
    return entries;
}

/// Adds a part for each command, and for its commands, such as "cert" and "cert list".
void add_commands(const CLI::App& app, const std::string& prefix, ManualPage& page)
{
    for (const CLI::App* command : commands_of(app)) {
        const std::string name = prefix + command->get_name();
        // Commands inherit the program's footer from CLI11.
        const std::string own = command->get_footer();
        const std::string footer = own == app.get_footer() ? "" : own;
        page.sections.push_back(
            {name + " " + arguments_of(*command),
             command->get_description() + (footer.empty() ? "" : "\n\n" + footer),
             entries_of(*command), true});
        add_commands(*command, name + " ", page);
    }
}

ManualPage page_of(const CLI::App& app, const std::string& program)
{
    const std::string& description = app.get_description();
    ManualPage page;
    page.program = program;
    page.summary = description.substr(0, description.find_first_of(".:"));
    page.arguments = arguments_of(app);
    page.sections.push_back({"DESCRIPTION", description, {}, false});
    page.sections.push_back({"OPTIONS", "", entries_of(app), false});
    if (!commands_of(app).empty()) {
        page.sections.push_back({"COMMANDS", "", {}, false});
        add_commands(app, "", page);
    }
    if (const std::string footer = app.get_footer(); !footer.empty()) {
        page.sections.push_back({"NOTES", footer, {}, false});
    }
    return page;
}

std::string words_of(const CLI::App& app)
{
    std::string words;
    for (const CLI::App* command : commands_of(app)) {
        words += " " + command->get_name();
    }
    for (const CLI::Option* option : options_of(app, false)) {
        for (const std::string& name : option->get_lnames()) {
            words += " --" + name;
        }
    }
    return words.empty() ? words : words.substr(1);
}

/// Completes the commands and options of a program whose commands have no commands themselves.
std::string completion_of(const CLI::App& app, const std::string& program)
{
    std::string function = "_" + program;
    for (char& character : function) {
        character = character == '-' ? '_' : character;
    }
    std::string script =
        function + "() {\n  local word words='" + words_of(app) +
        "'\n  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n    case \"$word\" in\n";
    for (const CLI::App* command : commands_of(app)) {
        script += "      '" + command->get_name() + "') words='" + words_of(*command) + "' ;;\n";
    }
    return script +
           "      *) ;;\n    esac\n  done\n"
           "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n"
           "complete -o default -F " +
           function + " " + program + "\n";
}

/// Removes the final newline, because App::exit adds one.
std::string last_line_open(std::string text)
{
    if (text.ends_with('\n')) {
        text.pop_back();
    }
    return text;
}

} // namespace

void add_program_options(CLI::App& app, const std::string& program)
{
    app.set_version_flag("--version", program + " " + version(), "print the version and end");
    const auto add = [&app](const std::string& name, auto text) {
        const auto answer = [&app, text] {
            throw CLI::CallForVersion{last_line_open(text(app)), 0};
        };
        app.add_flag_callback(name, answer)->group("");
    };
    add("--print-man",
        [program](const CLI::App& all) { return text_of(page_of(all, program), version()); });
    add("--print-completion",
        [program](const CLI::App& all) { return completion_of(all, program); });
}

} // namespace busbar::command_line
