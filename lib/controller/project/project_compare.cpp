#include <busbar/controller/project_compare.hpp>

#include <map>

#include <busbar/core/text.hpp>

namespace busbar::controller {

namespace {

/// Values by names that both projects share.
using NamedValues = std::map<std::string, std::string>;

/// Turns "user 1.permission" into "user hmi: permission".
std::string shared_name(const Project& project, const std::string& name)
{
    constexpr std::string_view kind = "user ";
    const std::size_t point = name.find('.');
    if (!name.starts_with(kind) || point == std::string::npos) {
        return name;
    }
    const std::size_t number = std::stoul(name.substr(kind.size(), point - kind.size()));
    return "user " + project.users[number - 1].name + ": " + name.substr(point + 1);
}

NamedValues named_values(const Project& project)
{
    NamedValues named;
    for (ProjectValue& value : values_of(project)) {
        named[shared_name(project, value.name)] = std::move(value.value);
    }
    return named;
}

std::string shown_value(const NamedValues& values, const std::string& name)
{
    const auto found = values.find(name);
    if (found == values.end()) {
        return "nothing";
    }
    return name.ends_with("password_hash") ? "another password"
                                           : "\"" + printable(found->second, 64) + "\"";
}

} // namespace

std::vector<ProjectDifference> setting_differences(const Project& first, const Project& second)
{
    const NamedValues ours = named_values(first);
    const NamedValues theirs = named_values(second);
    NamedValues all = ours;
    all.insert(theirs.begin(), theirs.end());
    std::vector<ProjectDifference> differences;
    for (const auto& [name, value] : all) {
        const auto a = ours.find(name);
        const auto b = theirs.find(name);
        if (a != ours.end() && b != theirs.end() && a->second == b->second) {
            continue;
        }
        if (differences.size() == max_project_differences) {
            break;
        }
        differences.push_back({name, shown_value(ours, name), shown_value(theirs, name)});
    }
    return differences;
}

} // namespace busbar::controller
