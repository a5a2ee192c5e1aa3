#include "commands.hpp"

#include <filesystem>
#include <span>
#include <system_error>

#include <busbar/storage/folder_storage.hpp>

#include "tool/connection/server_trust.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool::project {

CLI::App* add_offline(CLI::App& project, Run& run, const char* name, const char* text,
                      std::size_t least, std::size_t most, const char* word_names, Action action,
                      const std::shared_ptr<ProjectArguments>& arguments)
{
    auto* command = project.add_subcommand(name, text);
    command->fallthrough();
    command->add_option(word_names, arguments->words);
    when_chosen(
        *command, run,
        [arguments, least, most, action, names = std::string{word_names}](Context& context) {
            for (std::string& word : arguments->words) {
                unmark(word);
            }
            for (std::string* option : {&arguments->part, &arguments->label}) {
                unmark(*option);
            }
            if (arguments->words.size() < least || arguments->words.size() > most) {
                throw Failure{Exit::Usage, std::to_string(arguments->words.size()) + " arguments",
                              "expected " + names};
            }
            return action(context, *arguments);
        });
    return command;
}

controller::Project open_project(const std::string& path)
{
    const std::string text = read_file(path, controller::ProjectLimits{}.max_file_size);
    auto project = controller::read_project(text, path);
    if (!project) {
        throw Failure{Exit::Failed, busbar::text(project.error()),
                      "see `busbar project new` for what a project is"};
    }
    return *std::move(project);
}

void save_file(const std::string& path, const std::string& text)
{
    const auto place = std::filesystem::path{path};
    storage::FolderStorage files{place.parent_path().empty() ? "." : place.parent_path().string()};
    const auto kept =
        files.replace(place.filename().string(), std::as_bytes(std::span{text}), FileAccess::Owner);
    if (!kept) {
        throw Failure{Exit::Failed, path + ": " + std::string{busbar::text(kept.error())},
                      "nothing was written"};
    }
}

void save_project(const std::string& path, const controller::Project& project)
{
    const auto document = controller::document_of(project);
    if (!document) {
        throw Failure{Exit::Failed, path + ": " + busbar::text(document.error()),
                      "nothing was written"};
    }
    save_file(path, *document);
}

void make_room(Context& context, const std::string& path, bool is_sure)
{
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !is_sure &&
        !confirm(context, "replace " + path + "?")) {
        throw Failure{Exit::Failed, "nothing was done", "--yes does it without a question"};
    }
}

} // namespace busbar::tool::project
