#include "commands.hpp"

#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

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
    std::vector<Difference> rows;
    for (const controller::ProjectDifference& each : differences) {
        rows.push_back({each.where, each.first, each.second});
    }
    return tool::print_differences(context, rows, {"WHERE", first, second});
}

void add_compare(CLI::App& project, Run& run)
{
    add_offline(project, run, "compare", "Lists what differs between two projects, label by label.",
                2, 2, "FILE OTHER", compare_projects, std::make_shared<ProjectArguments>());
}

} // namespace busbar::tool::project
