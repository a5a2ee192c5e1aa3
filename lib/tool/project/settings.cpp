#include <algorithm>
#include <memory>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_rules.hpp>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/connection/credentials.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

/// Saves the project unless its values contradict each other. Does not check its models.
void check_and_save(const std::string& path, const controller::Project& project)
{
    if (const auto checked = controller::check(project); !checked) {
        throw Failure{Exit::Failed, path + ": " + text(checked.error()), "nothing was changed"};
    }
    save_project(path, project);
}

void change(controller::Project& project, const std::string& name, const std::string& value)
{
    if (const auto set = controller::set_project_value(project, name, value); !set) {
        throw Failure{Exit::Usage, text(set.error()),
                      "`busbar project show` lists the names of all values"};
    }
}

Exit make_new(Context& context, const ProjectArguments& arguments)
{
    const std::string& path = arguments.words[0];
    controller::Project project;
    project.preset = arguments.preset;
    make_room(context, path, arguments.is_sure);
    check_and_save(path, project);
    return admin::report(context, "made " + path);
}

Exit show(Context& context, const ProjectArguments& arguments)
{
    const controller::Project project = open_project(arguments.words[0]);
    if (arguments.words.size() > 1) {
        return show_node(context, project, arguments.words[1]);
    }
    const auto urls = controller::endpoint_urls(project.network);
    JsonLine json;
    json.open_object().key("values").open_object();
    Table table{{{"NAME", 24}, {"VALUE", 16}}};
    for (const controller::ProjectValue& value : controller::values_of(project)) {
        json.member(value.name, value.value);
        table.add({{value.name}, {safe(value.value)}});
    }
    json.close_object().key("endpointUrls").texts(urls).key("models").open_array();
    for (const controller::ProjectModel& model : project.models) {
        json.open_object().member("name", model.name);
        json.member("size", static_cast<std::int64_t>(model.text.size())).close_object();
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().close_object().document());
        return Exit::Good;
    }
    table.print(context.out);
    for (const std::string& url : urls) {
        context.out.line("end point: " + safe(url));
    }
    for (const controller::ProjectModel& model : project.models) {
        context.out.line("model: " + safe(model.name) + ", " + std::to_string(model.text.size()) +
                         " bytes");
    }
    return Exit::Good;
}

/// Sets any number of values at once, because some are valid only together.
Exit set(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    controller::Project project = open_project(words[0]);
    if (words.size() % 2 == 0) {
        throw Failure{Exit::Usage, "a name without a value",
                      "expected FILE NAME VALUE [NAME VALUE]..., a value may be \"\""};
    }
    for (std::size_t i = 1; i < words.size(); i += 2) {
        change(project, words[i], words[i + 1]);
    }
    check_and_save(words[0], project);
    return admin::report(context, std::to_string(words.size() / 2) + " values set");
}

/// Index of the user with this name, or of a new one.
std::size_t number_of(controller::Project& project, const std::string& name)
{
    const auto found =
        std::find_if(project.users.begin(), project.users.end(),
                     [&](const controller::ProjectUser& each) { return each.name == name; });
    const auto number = static_cast<std::size_t>(found - project.users.begin()) + 1;
    if (found == project.users.end()) {
        project.users.emplace_back().name = name;
    }
    return number;
}

Exit set_user(Context& context, const ProjectArguments& arguments)
{
    const std::string& name = arguments.words[1];
    controller::Project project = open_project(arguments.words[0]);
    const crypto::Secret password = new_password(context, name, arguments.new_password_file);
    const server::PasswordRules rules =
        project.preset.empty() ? server::PasswordRules{} : server::rd81opc96_password_rules();
    if (const auto allowed = server::check_password(rules, name, password.text()); !allowed) {
        throw Failure{Exit::Failed, text(allowed.error()), "nothing was changed"};
    }
    crypto::PasswordCost cost = rules.cost;
    if (arguments.pbkdf2_iterations != 0) {
        cost.scheme = crypto::PasswordScheme::Pbkdf2;
        cost.iterations = arguments.pbkdf2_iterations;
    }
    crypto::SystemRandom random;
    auto hash = crypto::hash_password(password.text(), random, cost);
    if (!hash) {
        throw Failure{hash.error(), "hashing the password"};
    }
    const std::size_t number = number_of(project, name);
    project.users[number - 1].password_hash = *std::move(hash);
    if (!arguments.permission.empty()) {
        change(project, "user " + std::to_string(number) + ".permission", arguments.permission);
    }
    check_and_save(arguments.words[0], project);
    return admin::report(context, safe(name) + " may log in");
}

} // namespace

void add_settings(CLI::App& project, Run& run)
{
    const auto arguments = std::make_shared<ProjectArguments>();
    auto* made = add_offline(project, run, "new", "Makes a project file without models.", 1, 1,
                             "FILE", make_new, arguments);
    made->add_option("--preset", arguments->preset,
                     "rd81opc96: with the ceilings and characters of that product");
    made->add_flag("--yes", arguments->is_sure, "replace a file without a question");
    add_offline(project, run, "show",
                "Lists the values of a project and its end points, or all about one node.", 1, 2,
                "FILE [NODE]", show, arguments);
    add_offline(project, run, "set", "Sets values of a project, all or none.", 3, 1'000,
                "FILE NAME VALUE", set, arguments);
    auto* user = add_offline(project, run, "user", "Adds a user, or gives one another password.", 2,
                             2, "FILE NAME", set_user, arguments);
    user->add_option("--new-password-file", arguments->new_password_file,
                     "its first line is the password; asked for on a terminal otherwise");
    user->add_option("--pbkdf2-iterations", arguments->pbkdf2_iterations,
                     "stores a hash for servers without the 16.8 MB that each login takes "
                     "otherwise; 600000 is usual")
        ->check(CLI::Range(10'000U, 10'000'000U));
    user->add_option("--permission", arguments->permission,
                     "\"tool\", \"client\" or \"tool and client\", which a new user has");
}

} // namespace busbar::tool::project
