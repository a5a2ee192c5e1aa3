#include <busbar/controller/node_roles.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <busbar/controller/model_set.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/types/ids.hpp>

#include "core/number_text.hpp"

namespace busbar::controller {

namespace {

constexpr std::string_view no_role = "none";

struct NamedRole {
    std::string_view name;
    std::uint32_t id;
};

/// The roles that every server has (Part 3, 4.9.2).
constexpr std::array known_roles{
    NamedRole{"Anonymous", id::WellKnownRole_Anonymous},
    NamedRole{"AuthenticatedUser", id::WellKnownRole_AuthenticatedUser},
    NamedRole{"TrustedApplication", id::WellKnownRole_TrustedApplication},
    NamedRole{"Observer", id::WellKnownRole_Observer},
    NamedRole{"Operator", id::WellKnownRole_Operator},
    NamedRole{"Engineer", id::WellKnownRole_Engineer},
    NamedRole{"Supervisor", id::WellKnownRole_Supervisor},
    NamedRole{"ConfigureAdmin", id::WellKnownRole_ConfigureAdmin},
    NamedRole{"SecurityAdmin", id::WellKnownRole_SecurityAdmin},
};

constexpr std::uint32_t bits(PermissionType permission)
{
    return static_cast<std::uint32_t>(permission);
}

constexpr std::uint32_t browsing = bits(PermissionType::Browse);
constexpr std::uint32_t reading = browsing | bits(PermissionType::Read) |
                                  bits(PermissionType::ReadHistory) |
                                  bits(PermissionType::ReceiveEvents);
constexpr std::uint32_t writing = reading | bits(PermissionType::Write);
constexpr std::uint32_t calling = browsing | bits(PermissionType::Call);
constexpr std::uint32_t everything = 2 * bits(PermissionType::AddNode) - 1;

struct NamedRight {
    std::string_view name;
    std::uint32_t permissions;
};

/// Those that include others come first.
constexpr std::array known_rights{NamedRight{"all", everything}, NamedRight{"write", writing},
                                  NamedRight{"read", reading}, NamedRight{"call", calling},
                                  NamedRight{"browse", browsing}};

bool is_known(const NodeId& role)
{
    return std::any_of(known_roles.begin(), known_roles.end(),
                       [&](const NamedRole& each) { return role.is(each.id); });
}

std::string role_name(const NodeId& role)
{
    const auto* const known = std::find_if(known_roles.begin(), known_roles.end(),
                                           [&](const NamedRole& each) { return role.is(each.id); });
    return known != known_roles.end() ? std::string{known->name} : to_string(role);
}

std::string rights_text(std::uint32_t permissions)
{
    std::string words;
    std::uint32_t said = 0;
    for (const NamedRight& right : known_rights) {
        if ((permissions & right.permissions) == right.permissions &&
            (said & right.permissions) != right.permissions) {
            words += (words.empty() ? "" : "+") + std::string{right.name};
            said |= right.permissions;
        }
    }
    return said == permissions && said != 0 ? words : std::to_string(permissions);
}

std::string all_names()
{
    std::string names;
    for (const NamedRole& each : known_roles) {
        names += (names.empty() ? "" : ", ") + std::string{each.name};
    }
    return names;
}

std::optional<std::uint32_t> parse_right(std::string_view word)
{
    for (const NamedRight& each : known_rights) {
        if (each.name == word) {
            return each.permissions;
        }
    }
    std::uint32_t number = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = busbar::detail::read_number(word.data(), end, number);
    return error == std::errc{} && stop == end ? std::optional{number} : std::nullopt;
}

std::optional<NodeId> parse_role(std::string_view name)
{
    for (const NamedRole& each : known_roles) {
        if (each.name == name) {
            return NodeId{0, each.id};
        }
    }
    const auto id = parse_expanded_node_id(name);
    return id && id->namespace_uri.empty() && id->server_index == 0 ? std::optional{id->node_id}
                                                                    : std::nullopt;
}

/// Parses "Operator=write+call".
Configured<RolePermissionType> parse_entry(std::string_view text)
{
    const std::size_t sign = text.rfind('='); // a NodeId has one, too
    const std::string_view name = text.substr(0, sign);
    if (sign == std::string_view::npos || sign + 1 == text.size()) {
        return misconfigured(printable(text, 64),
                             "found no right, expected a role and its rights, such as "
                             "Operator=write+call");
    }
    const auto role = parse_role(name);
    if (!role) {
        return misconfigured(printable(name, 64),
                             "found no such role, expected one of " + all_names());
    }
    std::uint32_t permissions = 0;
    for (std::string_view rest = text.substr(sign + 1);;) {
        const std::size_t end = std::min(rest.find('+'), rest.size());
        const auto right = parse_right(rest.substr(0, end));
        if (!right) {
            return misconfigured(printable(name, 64),
                                 "found " + printable(rest.substr(0, end), 64) +
                                     ", expected browse, read, write, call or all, with + between");
        }
        permissions |= *right;
        if (end == rest.size()) {
            return RolePermissionType{*role, PermissionType{permissions}};
        }
        rest.remove_prefix(end + 1);
    }
}

/// Checks the RolePermissions of one node.
class RoleCheck {
public:
    RoleCheck(const model::SpaceReader& space, ModelReports& reports)
        : space_{space}, reports_{reports}
    {
    }

    void check(model::NodeIndex node)
    {
        const model::NodeAccess* const access = space_.node_access(node);
        if (access == nullptr || access->role_permissions.is_null()) {
            return;
        }
        std::uint32_t all = 0;
        for (const RolePermissionType& each : access->role_permissions) {
            all |= bits(each.permissions);
            if (!is_known(each.role_id) && space_.find(each.role_id) == model::no_node) {
                report(ModelCode::RoleUnknown, node, to_string(each.role_id));
            }
        }
        check_rights(node, all);
    }

private:
    void check_rights(model::NodeIndex node, std::uint32_t all)
    {
        constexpr auto current_write = static_cast<std::uint8_t>(AccessLevelType::CurrentWrite);
        const bool has_write = (all & bits(PermissionType::Write)) != 0;
        const bool has_call = (all & bits(PermissionType::Call)) != 0;
        switch (space_.node_class(node)) {
        case NodeClass::Variable:
            if (has_write && (space_.variable(node).access_level & current_write) == 0) {
                report(ModelCode::RightUnused, node, "write, but its AccessLevel is read only");
            }
            break;
        case NodeClass::Method:
            if (has_write && !has_call) {
                report(ModelCode::RightUnused, node, "write for a Method, expected call");
            }
            break;
        default:
            break;
        }
    }
    void report(ModelCode code, model::NodeIndex node, std::string_view found)
    {
        const NodeId id = space_.node_id(node);
        reports_.add({code, id, printable(to_string(id), 512), printable(found)});
    }

    const model::SpaceReader& space_;
    ModelReports& reports_;
};

} // namespace

std::string roles_text(std::span<const RolePermissionType> permissions)
{
    std::string text;
    for (const RolePermissionType& each : permissions) {
        text += text.empty() ? "" : " ";
        text += role_name(each.role_id) + "=" + rights_text(bits(each.permissions));
    }
    return text.empty() ? std::string{no_role} : text;
}

Configured<Array<RolePermissionType>> parse_roles(std::string_view text)
{
    Array<RolePermissionType> roles;
    roles.clear(); // not null
    if (text == no_role) {
        return roles;
    }
    constexpr std::string_view blanks = " \t";
    for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;
         at = text.find_first_not_of(blanks, at)) {
        const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
        auto entry = parse_entry(text.substr(at, end - at));
        if (!entry) {
            return Unexpected{std::move(entry).error()};
        }
        const bool is_repeated = std::any_of(roles.begin(), roles.end(), [&](const auto& each) {
            return each.role_id == entry->role_id;
        });
        if (is_repeated) {
            return misconfigured(role_name(entry->role_id), "found it twice, expected it once");
        }
        roles.push_back(*std::move(entry));
        at = end;
    }
    return roles.empty() ? misconfigured("roles", "found nothing, expected none or a role and "
                                                  "its rights, such as Operator=write")
                         : Configured<Array<RolePermissionType>>{std::move(roles)};
}

ModelReports check_roles(const ModelSet& models)
{
    ModelReports reports;
    const model::SpaceReader& space = models.space();
    RoleCheck check{space, reports};
    std::vector<std::pair<NodeId, model::NodeIndex>> nodes;
    space.for_each([&](model::NodeIndex node) {
        if (space.node_access(node) != nullptr && space.node_id(node).namespace_index() != 0) {
            nodes.emplace_back(space.node_id(node), node);
        }
    });
    std::sort(nodes.begin(), nodes.end());
    for (const auto& [id, node] : nodes) {
        check.check(node);
    }
    return reports;
}

} // namespace busbar::controller
