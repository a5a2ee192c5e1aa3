#include <algorithm>
#include <utility>
#include <vector>

#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/node_roles.hpp>
#include <busbar/controller/project_models.hpp>
#include <busbar/core/text_forms.hpp>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::ModelSet;
using model::NodeIndex;

/// Returns null if the node has no RolePermissions of its own.
const Array<RolePermissionType>* roles_of(const model::SpaceReader& space, NodeIndex node)
{
    const model::NodeAccess* const access = space.node_access(node);
    return access != nullptr && !access->role_permissions.is_null() ? &access->role_permissions
                                                                    : nullptr;
}

/// Lists these nodes with their roles.
Exit list_roles(Context& context, const model::SpaceReader& space,
                const std::vector<NodeIndex>& nodes)
{
    JsonLine json;
    json.open_array();
    Table table{{{"NODE", 16}, {"NAME", 12}, {"ROLES", 16, false, true}}};
    for (const NodeIndex node : nodes) {
        const auto* const roles = roles_of(space, node);
        const std::string text = roles == nullptr ? "" : controller::roles_text(roles->span());
        const std::string id = to_string(space.node_id(node));
        const std::string name = to_string(space.browse_name(node));
        json.open_object().member("nodeId", id).member("name", name);
        json.member("roles", text).close_object();
        table.add({{safe(id)}, {safe(name)}, {text.empty() ? "everybody" : safe(text)}});
    }
    return print_rows(context, json.close_array(), table);
}

std::vector<NodeIndex> nodes_with_roles(const model::SpaceReader& space)
{
    std::vector<NodeIndex> nodes;
    space.for_each([&](NodeIndex node) {
        if (space.node_id(node).namespace_index() != 0 && roles_of(space, node) != nullptr) {
            nodes.push_back(node);
        }
    });
    std::sort(nodes.begin(), nodes.end(),
              [&](NodeIndex a, NodeIndex b) { return space.node_id(a) < space.node_id(b); });
    return nodes;
}

NodeIndex node_of_model(const model::SpaceReader& space, const std::string& text)
{
    const NodeIndex node = controller::find_table_node(text, space);
    if (node == model::no_node) {
        throw Failure{Exit::Failed, safe(text) + ": there is no such node",
                      "`busbar project tree` lists the nodes"};
    }
    if (space.node_id(node).namespace_index() == 0) {
        throw Failure{Exit::Failed, safe(text) + ": is a node of namespace 0, which no model has",
                      "expected a node of an imported model"};
    }
    return node;
}

/// Parses the words after the node; null for "".
Array<RolePermissionType> roles_of_words(const std::vector<std::string>& words)
{
    if (words.size() == 3 && words[2].empty()) {
        return {};
    }
    std::string text;
    for (std::size_t i = 2; i < words.size(); ++i) {
        text += (text.empty() ? "" : " ") + words[i];
    }
    auto roles = controller::parse_roles(text);
    if (!roles) {
        throw Failure{Exit::Usage, safe(busbar::text(roles.error())), "nothing was changed"};
    }
    return *std::move(roles);
}

/// Without ROLE=RIGHTS lists the roles of a node, or of all nodes.
Exit change_roles(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    controller::Project project = open_project(words[0]);
    ModelSet models = open_models(project);
    if (words.size() == 1) {
        return list_roles(context, models.space(), nodes_with_roles(models.space()));
    }
    const NodeIndex node = node_of_model(models.space(), words[1]);
    if (words.size() == 2) {
        return list_roles(context, models.space(), {node});
    }
    auto roles = roles_of_words(words);
    const std::string text = roles.is_null() ? "everybody" : controller::roles_text(roles.span());
    models.set_roles(node, std::move(roles));
    const NodeId id = models.space().node_id(node);
    const auto reports = controller::check_roles(models);
    for (const controller::ModelReport& report : reports.list()) {
        if (report.node == id) {
            context.warn("warning", safe(controller::text(report)));
        }
    }
    controller::keep_models(models, project);
    save_project(words[0], project);
    return admin::report(context, safe(words[1]) + " is for " + safe(text));
}

} // namespace

void add_roles(CLI::App& project, Run& run)
{
    constexpr std::size_t most_words = 64;
    auto* command = add_offline(
        project, run, "roles", "Says which roles may do what with a node; lists it without a role.",
        1, most_words, "FILE [NODE] [ROLE=RIGHTS]...", change_roles,
        std::make_shared<ProjectArguments>());
    command->footer("RIGHTS are browse, read, write, call or all, with + between them; write\n"
                    "includes read, and each of them browse. Only users with one of the roles\n"
                    "see the node. The word none takes all rights away, \"\" all roles.\n"
                    "Every user has the role Anonymous, and after a login AuthenticatedUser.");
}

} // namespace busbar::tool::project
