#include "commands.hpp"

#include <algorithm>

#include "core/ascii_case.hpp"
#include "reports.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

std::string lower(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), busbar::detail::to_ascii_lower);
    return text;
}

Exit compare_projects(Context& context, const ProjectArguments& arguments)
{
    const controller::Project first = open_project(arguments.words[0]);
    const controller::Project second = open_project(arguments.words[1]);
    return print_differences(context, differences_of(first, second), "FIRST", "SECOND");
}

} // namespace

std::vector<controller::ProjectDifference> differences_of(const controller::Project& first,
                                                          const controller::Project& second)
{
    auto differences = controller::setting_differences(first, second);
    const auto models = controller::model_differences(first, second);
    differences.insert(differences.end(), models.begin(), models.end());
    return differences;
}

Exit print_differences(Context& context,
                       const std::vector<controller::ProjectDifference>& differences,
                       const char* first, const char* second)
{
    JsonLine json;
    json.open_object().key("differences").open_array();
    Table table{{{"WHERE", 24}, {first, 16}, {second, 16}}};
    for (const controller::ProjectDifference& each : differences) {
        json.open_object().member("where", each.where).member(lower(first), each.first);
        json.member(lower(second), each.second).close_object();
        table.add({{safe(each.where)}, {safe(each.first)}, {safe(each.second)}});
    }
    const bool is_same = differences.empty();
    if (context.options.is_json) {
        context.out.line(json.close_array().member("isSame", is_same).close_object().document());
    } else if (is_same) {
        context.out.line("no differences");
    } else {
        table.print(context.out);
    }
    return is_same ? Exit::Good : Exit::Failed;
}

void add_compare(CLI::App& project, Run& run)
{
    add_offline(project, run, "compare", "Lists what differs between two projects, label by label.",
                2, 2, "FILE OTHER", compare_projects, std::make_shared<ProjectArguments>());
}

} // namespace busbar::tool::project
