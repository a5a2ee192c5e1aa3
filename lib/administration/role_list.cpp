#include <busbar/administration/role_list.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/administration/configured_users.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>

#include "core/utf8.hpp"

#include "role_rules.hpp"

namespace busbar::administration {

namespace {

constexpr std::string_view ua_uri = "http://opcfoundation.org/UA/";
/// The well-known roles of Part 3, 4.9.2.
constexpr std::array<std::string_view, 9> well_known{
    "Anonymous", "AuthenticatedUser", "TrustedApplication", "Observer",     "Operator",
    "Engineer",  "Supervisor",        "ConfigureAdmin",     "SecurityAdmin"};

Unexpected<Refusal> refuse_role(StatusCode status, std::string_view role, std::string found)
{
    return refuse({status,
                   "role set",
                   "role \"" + printable(role) + "\" " + std::move(found),
                   "Part 18, 4",
                   {}});
}

/// True for roles that are defined by their single rule.
bool is_fixed(const RoleRules& role)
{
    return role.namespace_uri == ua_uri &&
           (role.name == "Anonymous" || role.name == "AuthenticatedUser" ||
            role.name == "TrustedApplication");
}

bool is_of_administrators(const RoleRules& role)
{
    return role.namespace_uri == ua_uri && role.name == "SecurityAdmin";
}

/// True if no session can have the role, whatever its rules are.
bool admits_nobody(const RoleRules& role)
{
    return (!role.applications_exclude && role.applications.empty()) ||
           (!role.endpoints_exclude && role.endpoints.empty());
}

template <typename T, typename Value>
Checked<void> add_to(std::vector<T>& list, const Value& value, const RoleRules& role,
                     std::size_t most)
{
    if (std::find(list.begin(), list.end(), value) != list.end()) {
        return refuse_role(status::Bad_AlreadyExists, role.name, "has that rule already");
    }
    if (list.size() >= most) {
        return refuse_role(status::Bad_ResourceUnavailable, role.name,
                           "has " + std::to_string(most) + " such rules, which is the limit");
    }
    list.push_back(T{value});
    return {};
}

template <typename T, typename Value>
Checked<void> remove_from(std::vector<T>& list, const Value& value, const RoleRules& role)
{
    const auto found = std::find(list.begin(), list.end(), value);
    if (found == list.end()) {
        return refuse_role(status::Bad_NotFound, role.name, "has no such rule");
    }
    list.erase(found);
    return {};
}

// Copies a rule with texts of its own, because a request may have lent them. Null texts become
// empty, which means the same here.

IdentityMappingRuleType own_copy(const IdentityMappingRuleType& rule)
{
    IdentityMappingRuleType own;
    own.criteria_type = rule.criteria_type;
    own.criteria = String{rule.criteria.str()};
    return own;
}

EndpointType own_copy(const EndpointType& endpoint)
{
    EndpointType own;
    own.endpoint_url = String{endpoint.endpoint_url.str()};
    own.security_mode = endpoint.security_mode;
    own.security_policy_uri = String{endpoint.security_policy_uri.str()};
    own.transport_profile_uri = String{endpoint.transport_profile_uri.str()};
    return own;
}

Checked<void> check_fixed(const RoleRules& role)
{
    if (is_fixed(role)) {
        return refuse_role(status::Bad_RequestNotAllowed, role.name,
                           "has the one rule that its name implies, which cannot change");
    }
    return {};
}

} // namespace

namespace detail {

std::vector<RoleRules> well_known_roles()
{
    std::vector<RoleRules> roles;
    for (const std::string_view name : well_known) {
        RoleRules role;
        role.name = name;
        role.namespace_uri = ua_uri;
        if (name == "Anonymous") {
            role.identities = {{IdentityCriteriaType::Anonymous, {}},
                               {IdentityCriteriaType::AuthenticatedUser, {}}};
        } else if (name == "AuthenticatedUser") {
            role.identities = {{IdentityCriteriaType::AuthenticatedUser, {}}};
        } else if (name == "TrustedApplication") {
            role.identities = {{IdentityCriteriaType::TrustedApplication, {}}};
        }
        roles.push_back(std::move(role));
    }
    return roles;
}

} // namespace detail

RoleList::RoleList(Storage& storage, std::string file, const RoleLimits& limits,
                   const ConfiguredUsers* configured)
    : storage_{&storage}, file_{std::move(file)}, limits_{limits},
      roles_{detail::well_known_roles()}, configured_{configured}
{
}

Configured<void> RoleList::load()
{
    auto roles = detail::read_roles(*storage_, file_, limits_);
    if (!roles) {
        return Unexpected{roles.error()};
    }
    const std::lock_guard lock{mutex_};
    roles_ = *std::move(roles);
    return {};
}

const RoleRules* RoleList::find(std::string_view name) const
{
    const auto found = std::find_if(roles_.begin(), roles_.end(),
                                    [&](const RoleRules& role) { return role.name == name; });
    return found == roles_.end() ? nullptr : &*found;
}

std::vector<IdentityMappingRuleType> RoleList::identities_of(std::string_view name) const
{
    std::vector<IdentityMappingRuleType> all;
    const RoleRules* const role = find(name);
    if (role != nullptr && configured_ != nullptr) {
        all = configured_->identities_of(name);
    }
    if (role != nullptr) {
        all.insert(all.end(), role->identities.begin(), role->identities.end());
    }
    return all;
}

bool RoleList::is_configured(std::string_view role, const IdentityMappingRuleType& rule) const
{
    const auto given = configured_ != nullptr ? configured_->identities_of(role)
                                              : std::vector<IdentityMappingRuleType>{};
    return std::find(given.begin(), given.end(), own_copy(rule)) != given.end();
}

bool RoleList::is_well_known(std::string_view name)
{
    return std::find(well_known.begin(), well_known.end(), name) != well_known.end();
}

std::string RoleList::closed_document(std::span<const std::string> others)
{
    std::vector<RoleRules> roles = detail::well_known_roles();
    for (const std::string& name : others) {
        const bool is_there = std::ranges::find(roles, name, &RoleRules::name) != roles.end();
        if (!is_there && roles.size() < RoleLimits{}.max_roles) {
            roles.emplace_back().name = name;
        }
    }
    for (RoleRules& role : roles) {
        role.endpoints_exclude = is_fixed(role) || is_of_administrators(role);
    }
    return detail::document_of(roles);
}

Checked<void> RoleList::replace(std::vector<RoleRules> roles)
{
    const std::string document = detail::document_of(roles);
    const auto written = storage_->replace(
        file_, std::as_bytes(std::span{document.data(), document.size()}), FileAccess::Owner);
    if (!written) {
        return refuse(
            {status_of(written.error()),
             "role set",
             storage_->place(file_) + " cannot be written: " + std::string{text(written.error())},
             {},
             "Nothing was changed"});
    }
    const std::lock_guard lock{mutex_};
    roles_ = std::move(roles);
    return {};
}

template <typename Change>
Checked<void> RoleList::change(std::string_view name, Change change)
{
    std::vector<RoleRules> roles = roles_;
    const auto found = std::find_if(roles.begin(), roles.end(),
                                    [&](const RoleRules& role) { return role.name == name; });
    if (found == roles.end()) {
        return refuse_role(status::Bad_NotFound, name, "does not exist");
    }
    const bool had_rules = !found->identities.empty();
    const bool admitted_nobody = admits_nobody(*found);
    if (Checked<void> changed = change(*found); !changed) {
        return changed;
    }
    if (is_of_administrators(*found) && had_rules && found->identities.empty() &&
        (configured_ == nullptr || !configured_->has_administrator())) {
        return refuse_role(status::Bad_RequestNotAllowed, name,
                           "would have no rule left, so that no user could administer the server");
    }
    if (is_of_administrators(*found) && !admitted_nobody && admits_nobody(*found)) {
        return refuse_role(status::Bad_RequestNotAllowed, name,
                           "would be limited to an empty list of applications or endpoints, so "
                           "that no user could administer the server; add to the list first");
    }
    return replace(std::move(roles));
}

Checked<void> RoleList::add(std::string name, std::string namespace_uri)
{
    if (name.empty() || name.size() > limits_.max_text || namespace_uri.size() > limits_.max_text) {
        return refuse_role(status::Bad_InvalidArgument, name, "has an empty or overlong name");
    }
    if (!busbar::detail::is_name(name) ||
        (!namespace_uri.empty() && !busbar::detail::is_name(namespace_uri))) {
        return refuse_role(
            status::Bad_InvalidArgument, name,
            "has a name that is not UTF-8, or has control characters or spaces at either end");
    }
    if (find(name) != nullptr) {
        return refuse_role(status::Bad_AlreadyExists, name, "already exists");
    }
    if (roles_.size() >= limits_.max_roles) {
        return refuse_role(status::Bad_ResourceUnavailable, name,
                           "would exceed the limit of " + std::to_string(limits_.max_roles));
    }
    std::vector<RoleRules> roles = roles_;
    RoleRules role;
    role.name = std::move(name);
    role.namespace_uri = std::move(namespace_uri);
    roles.push_back(std::move(role));
    return replace(std::move(roles));
}

Checked<void> RoleList::remove(std::string_view name)
{
    std::vector<RoleRules> roles = roles_;
    const auto found = std::find_if(roles.begin(), roles.end(),
                                    [&](const RoleRules& role) { return role.name == name; });
    if (found == roles.end()) {
        return refuse_role(status::Bad_NodeIdUnknown, name, "does not exist");
    }
    if (is_well_known(name)) {
        return refuse_role(status::Bad_RequestNotAllowed, name,
                           "is a well-known role, which cannot be removed");
    }
    roles.erase(found);
    return replace(std::move(roles));
}

Checked<void> RoleList::add_identity(std::string_view role, const IdentityMappingRuleType& rule)
{
    return change(role, [&](RoleRules& changed) -> Checked<void> {
        const std::string_view criteria = rule.criteria.view();
        if (!criteria.empty() && !busbar::detail::is_name(criteria)) {
            return refuse_role(status::Bad_InvalidArgument, role,
                               "cannot get a rule with control characters or spaces at either end");
        }
        if (const StatusCode bad = detail::check_rule(rule, limits_.max_text); bad.is_bad()) {
            return refuse_role(bad, role,
                               "cannot get this rule: its type or criteria are not valid");
        }
        if (is_configured(role, rule)) {
            return refuse_role(status::Bad_AlreadyExists, role,
                               "has that rule from the configuration");
        }
        return check_fixed(changed).and_then(
            [&] { return add_to(changed.identities, own_copy(rule), changed, limits_.max_rules); });
    });
}

Checked<void> RoleList::remove_identity(std::string_view role, const IdentityMappingRuleType& rule)
{
    return change(role, [&](RoleRules& changed) -> Checked<void> {
        auto removed = check_fixed(changed).and_then(
            [&] { return remove_from(changed.identities, own_copy(rule), changed); });
        if (!removed && removed.error().status == status::Bad_NotFound &&
            is_configured(role, rule)) {
            return refuse_role(status::Bad_RequestNotAllowed, role,
                               "has that rule from the configuration; change it there");
        }
        return removed;
    });
}

Checked<void> RoleList::add_application(std::string_view role, std::string_view uri)
{
    return change(role, [&](RoleRules& changed) -> Checked<void> {
        if (uri.size() > limits_.max_text || !busbar::detail::is_name(uri)) {
            return refuse_role(status::Bad_InvalidArgument, role,
                               "cannot get an ApplicationUri that is not valid");
        }
        return check_fixed(changed).and_then([&] {
            return add_to(changed.applications, std::string{uri}, changed, limits_.max_rules);
        });
    });
}

Checked<void> RoleList::remove_application(std::string_view role, std::string_view uri)
{
    return change(role, [&](RoleRules& changed) {
        return remove_from(changed.applications, std::string{uri}, changed);
    });
}

Checked<void> RoleList::add_endpoint(std::string_view role, const EndpointType& endpoint)
{
    return change(role, [&](RoleRules& changed) -> Checked<void> {
        const std::size_t size = endpoint.endpoint_url.size() +
                                 endpoint.security_policy_uri.size() +
                                 endpoint.transport_profile_uri.size();
        const auto mode = static_cast<std::int32_t>(endpoint.security_mode);
        const auto is_name_or_empty = [](const String& text) {
            return text.empty() || busbar::detail::is_name(text.view());
        };
        const bool is_text = is_name_or_empty(endpoint.endpoint_url) &&
                             is_name_or_empty(endpoint.security_policy_uri) &&
                             is_name_or_empty(endpoint.transport_profile_uri);
        if (size > limits_.max_text || !is_text || mode < 0 || mode > 3) {
            return refuse_role(status::Bad_InvalidArgument, role,
                               "cannot get an endpoint that is not valid");
        }
        return check_fixed(changed).and_then([&] {
            return add_to(changed.endpoints, own_copy(endpoint), changed, limits_.max_rules);
        });
    });
}

Checked<void> RoleList::remove_endpoint(std::string_view role, const EndpointType& endpoint)
{
    return change(role, [&](RoleRules& changed) {
        return remove_from(changed.endpoints, own_copy(endpoint), changed);
    });
}

Checked<void> RoleList::set_applications_exclude(std::string_view role, bool excludes)
{
    return change(role, [&](RoleRules& changed) {
        return check_fixed(changed).transform([&] { changed.applications_exclude = excludes; });
    });
}

Checked<void> RoleList::set_endpoints_exclude(std::string_view role, bool excludes)
{
    return change(role, [&](RoleRules& changed) {
        return check_fixed(changed).transform([&] { changed.endpoints_exclude = excludes; });
    });
}

bool RoleList::is_administrator(std::string_view user) const
{
    const std::lock_guard lock{mutex_};
    const RoleRules* const role = find("SecurityAdmin");
    return role != nullptr &&
           std::any_of(role->identities.begin(), role->identities.end(),
                       [&](const IdentityMappingRuleType& rule) {
                           return rule.criteria_type == IdentityCriteriaType::UserName &&
                                  rule.criteria.view() == user;
                       });
}

server::UserRights RoleList::roles_of(const server::RoleQuestion& question) const
{
    server::UserRights rights{0, {}};
    for (const RoleRules& role : roles_) {
        // Anonymous and AuthenticatedUser follow from the token and are not assigned by the list.
        const bool is_of_token = role.name == "Anonymous" || role.name == "AuthenticatedUser";
        if (!is_of_token && detail::fits(role, question)) {
            rights.roles.push_back(role.name);
        }
    }
    if (!rights.roles.empty()) {
        rights.access_level_mask = detail::access_of(rights.roles);
    }
    return rights;
}

server::UserRights RoleList::limited(const server::RoleQuestion& question,
                                     server::UserRights rights) const
{
    std::erase_if(rights.roles, [&](const std::string& name) {
        const RoleRules* const role = find(name);
        return role != nullptr && !detail::admits(*role, question);
    });
    return rights;
}

} // namespace busbar::administration
