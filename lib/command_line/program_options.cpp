#include "program_options.hpp"

#include <memory>
#include <sstream>
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

/// Help in lines that a terminal of 80 columns has room for.
class NarrowFormatter final : public CLI::Formatter {
public:
    std::string make_option_desc(const CLI::Option* option) const override
    {
        return narrow(Formatter::make_option_desc(option), column_of_texts());
    }
    std::string make_subcommand(const CLI::App* command) const override
    {
        std::ostringstream out;
        CLI::detail::format_help(out, command->get_display_name(true),
                                 narrow(command->get_description(), column_of_texts()),
                                 get_column_width());
        return out.str();
    }
    std::string make_description(const CLI::App* app) const override
    {
        return narrow(Formatter::make_description(app), 0);
    }

private:
    [[nodiscard]] std::size_t column_of_texts() const { return get_column_width(); }
    /// Broken at blanks; lines that are there stay.
    static std::string narrow(const std::string& text, std::size_t indent)
    {
        constexpr std::size_t columns = 80;
        std::string result;
        std::size_t column = indent;
        std::size_t at = 0;
        while (at < text.size()) {
            const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
            if (column > indent && column + 1 + (end - at) > columns) {
                result += '\n';
                column = indent;
            } else if (column > indent) {
                result += ' ';
                ++column;
            }
            result += text.substr(at, end - at);
            column += end - at;
            if (end < text.size() && text[end] == '\n') {
                result += '\n';
                column = indent;
            }
            at = end + 1;
        }
        return result;
    }
};

/// Removes the final newline, because App::exit adds one.
std::string last_line_open(std::string text)
{
    if (text.ends_with('\n')) {
        text.pop_back();
    }
    return text;
}

} // namespace

void add_program_options(CLI::App& app, const std::string& program, const Completer& completer)
{
    app.formatter(std::make_shared<NarrowFormatter>());
    if (app.get_name().empty()) {
        app.name(program);
    }
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
        [program](const CLI::App&) { return completion_script(program, "bash"); });
    const auto breaks = std::make_shared<std::string>();
    const auto complete = [&app, completer, breaks](const std::string& line) {
        std::string text;
        for (const std::string& candidate : completions(app, line, completer, *breaks)) {
            text += candidate + "\n";
        }
        throw CLI::CallForVersion{last_line_open(text), 0};
    };
    // Its callback comes before that of the next one.
    app.add_option("--complete-breaks", *breaks)->group("");
    app.add_option_function<std::string>("--complete", complete)->group("");
}

} // namespace busbar::command_line
