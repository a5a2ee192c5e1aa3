#include "commands.hpp"

#include "tool/connection/context.hpp"
#include "tool/connection/server_trust.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool::admin {

namespace {

/// Throws Failure if the last word is a server, which would be another one than the command asks.
/// Values of settings can be URLs.
void refuse_late_url(const std::vector<std::string>& words, std::string_view word_names)
{
    if (!words.empty() && word_names.find("VALUE") == std::string_view::npos &&
        words.back().find("://") != std::string::npos && is_url(words.back())) {
        throw Failure{Exit::Usage, words.back() + ": the server comes before the other arguments"};
    }
}

} // namespace

Group::Group(CLI::App& parent, Run& run, const char* name, const char* text)
    : app_{name != nullptr ? parent.add_subcommand(name, text) : &parent}, run_{&run}
{
    if (name != nullptr) {
        app_->require_subcommand(1);
        app_->fallthrough();
    }
}

CLI::App* Group::add(const char* name, const char* text, std::size_t words, const char* word_names,
                     Action action, Connection::Endurance endurance)
{
    return add(name, text, word_names, std::optional{words}, action, endurance);
}

CLI::App* Group::add_any(const char* name, const char* text, const char* word_names, Action action)
{
    return add(name, text, word_names, std::nullopt, action, Connection::Endurance::Short);
}

CLI::App* Group::add(const char* name, const char* text, const char* word_names,
                     std::optional<std::size_t> words, Action action,
                     Connection::Endurance endurance)
{
    auto* command = app_->add_subcommand(name, text);
    command->fallthrough();
    command->add_option(word_names, arguments_->words,
                        words == 0 ? "server (optional)" : "server (optional), before the others");
    command->callback([run = run_, arguments = arguments_, words, action, endurance,
                       names = std::string{word_names}] {
        *run = [arguments, words, action, endurance, names](Context& context) {
            take_url(arguments->words, context.options, words.value_or(0));
            refuse_late_url(arguments->words, names);
            if (words && arguments->words.size() != *words) {
                throw Failure{Exit::Usage,
                              std::to_string(arguments->words.size()) + " arguments instead of " +
                                  std::to_string(*words),
                              "expected " + (words == 0 ? std::string{"none but a URL"} : names)};
            }
            Connection connection{
                context, arguments->log.is_followed ? Connection::Endurance::Lasting : endurance};
            return action(context, connection, *arguments);
        };
    });
    return command;
}

void make_sure(Context& context, const AdminArguments& arguments, const std::string& question)
{
    if (!arguments.is_sure && !confirm(context, question)) {
        throw Failure{Exit::Failed, "nothing was done", "--yes does it without a question"};
    }
}

Exit report(Context& context, const std::string& what)
{
    if (context.options.is_json) {
        JsonLine json;
        context.out.line(json.open_object().member("done", what).close_object().document());
    } else {
        context.out.line(wrap(what, context.out.columns(), 2));
    }
    return Exit::Good;
}

} // namespace busbar::tool::admin
