#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace roles {
namespace {

const NodeId role_set{0, id::Server_ServerCapabilities_RoleSet};

NodeId role_of(Connection& connection, const std::string& name)
{
    for (const NamedChild& role : objects_below(connection, role_set)) {
        if (role.name == name) {
            return role.id;
        }
    }
    throw Failure{status::Bad_NotFound, safe(name), "see `busbar admin role list`"};
}

const char* name_of(IdentityCriteriaType criteria)
{
    switch (criteria) {
    case IdentityCriteriaType::UserName:
        return "user";
    case IdentityCriteriaType::Thumbprint:
        return "thumbprint";
    case IdentityCriteriaType::Role:
        return "role";
    case IdentityCriteriaType::GroupId:
        return "group";
    case IdentityCriteriaType::Anonymous:
        return "anonymous";
    case IdentityCriteriaType::AuthenticatedUser:
        return "authenticated user";
    case IdentityCriteriaType::Application:
        return "application";
    case IdentityCriteriaType::X509Subject:
        return "subject";
    case IdentityCriteriaType::TrustedApplication:
        break;
    }
    return "trusted application";
}

/// The users that the configuration file defines, which gives them roles, too.
std::set<std::string> users_of_file(Connection& connection)
{
    std::set<std::string> names;
    for (const UserManagementDataType& user :
         find_users(connection).value_or(std::vector<UserManagementDataType>{})) {
        if (is_of_file(user)) {
            names.insert(user.user_name.str());
        }
    }
    return names;
}

/// Describes a rule: "user pat", or "user chief (of the file)".
std::string text_of(const IdentityMappingRuleType& rule, bool is_user_of_file)
{
    return name_of(rule.criteria_type) +
           (rule.criteria.empty() ? std::string{} : " " + safe(rule.criteria.view())) +
           (is_user_of_file ? " (of the file)" : "");
}

Exit list(Context& context, Connection& connection, const AdminArguments&)
{
    const std::set<std::string> of_file = users_of_file(connection);
    JsonLine json;
    json.open_array();
    Table table{{{"ROLE", 12}, {"GIVEN TO", 20}}};
    for (const NamedChild& role : objects_below(connection, role_set)) {
        const NodeId identities = find_child(connection, role.id, "Identities");
        if (identities.is_null()) {
            continue; // there are no rules, or this user may not see them
        }
        const Variant value = read(connection, identities);
        std::string whom;
        json.open_object().member("role", role.name).key("identities").open_array();
        if (const auto* const rules = value.array_if<ExtensionObject>()) {
            for (const ExtensionObject& each : *rules) {
                if (const auto* const rule = each.get_if<IdentityMappingRuleType>()) {
                    const bool is_user_of_file =
                        rule->criteria_type == IdentityCriteriaType::UserName &&
                        of_file.contains(rule->criteria.str());
                    whom += (whom.empty() ? "" : ", ") + text_of(*rule, is_user_of_file);
                    json.open_object().member("criteria", name_of(rule->criteria_type));
                    json.member("value", rule->criteria.view());
                    json.member("isUserOfFile", is_user_of_file).close_object();
                }
            }
        }
        json.close_array().close_object();
        table.add({{safe(role.name)}, {whom}});
    }
    return print_rows(context, json.close_array(), table);
}

/// Changes the role and describes the user and the role: "pat has the role Operator".
std::string change(Connection& connection, const AdminArguments& arguments, const char* method,
                   const std::string& what)
{
    const bool is_everyone = arguments.is_everyone;
    if (arguments.words.size() != (is_everyone ? 1U : 2U)) {
        throw Failure{Exit::Usage,
                      std::to_string(arguments.words.size()) + " arguments instead of " +
                          (is_everyone ? "1" : "2"),
                      is_everyone ? "expected ROLE, as --everyone takes the place of USER"
                                  : "expected USER ROLE"};
    }
    const std::string& name = arguments.words.back();
    const NodeId role = role_of(connection, name);
    const IdentityMappingRuleType rule =
        is_everyone ? IdentityMappingRuleType{IdentityCriteriaType::AuthenticatedUser, {}}
                    : IdentityMappingRuleType{IdentityCriteriaType::UserName,
                                              String{arguments.words.front()}};
    call(connection, role, child_of(connection, role, method),
         {Variant{ExtensionObject::from(rule)}}, what);
    return (is_everyone ? "every user who logs in" : safe(arguments.words.front())) +
           " has the role " + safe(name);
}

/// Warns of a name that is none of the server's users: a rule for it is allowed (Part 18, 4.4.2),
/// but is a mistake more often.
void warn_of_stranger(Context& context, Connection& connection, const std::string& name)
{
    const auto users = find_users(connection);
    if (users && std::none_of(users->begin(), users->end(),
                              [&](const auto& user) { return user.user_name.view() == name; })) {
        context.warn("warning", safe(name) + " is not a user of the server: the role waits for a "
                                             "user of that name, added later or named by a token. "
                                             "`busbar admin user list` shows the users");
    }
}

Exit grant(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string done = change(connection, arguments, "AddIdentity", "granting the role");
    if (!arguments.is_everyone) {
        warn_of_stranger(context, connection, arguments.words.front());
    }
    return report(context, done);
}

Exit revoke(Context& context, Connection& connection, const AdminArguments& arguments)
{
    return report(context, change(connection, arguments, "RemoveIdentity", "revoking the role") +
                               " no longer, unless another rule gives it");
}

} // namespace
} // namespace roles

void add_roles(CLI::App& admin, Run& run)
{
    using namespace roles;
    Group group{admin, run, "role", "Which roles users have."};
    group.add("list", "Lists roles and the rules that assign them.", 0, "URL", list);
    auto& arguments = group.arguments();
    constexpr const char* whose = "instead of one USER, all users who do not log in as anonymous";
    group.add_any("grant", "Gives a user a role.", "USER ROLE", grant)
        ->add_flag("--everyone", arguments.is_everyone, whose);
    group.add_any("revoke", "Takes a role from a user.", "USER ROLE", revoke)
        ->add_flag("--everyone", arguments.is_everyone, whose);
}

} // namespace busbar::tool::admin
