#include "role_rules.hpp"

#include <algorithm>
#include <optional>

#include "json_file.hpp"

namespace busbar::administration::detail {

namespace {

constexpr std::uint32_t version = 1;

void write_member(JsonWriter& json, std::string_view name, std::string_view text)
{
    json.name(name);
    json.string(text);
}

void write_flag(JsonWriter& json, std::string_view name, bool flag)
{
    json.name(name);
    json.word(flag ? "true" : "false");
}

void write_number(JsonWriter& json, std::string_view name, std::int32_t number)
{
    json.name(name);
    json.word(std::to_string(number));
}

void write_role(JsonWriter& json, const RoleRules& role)
{
    json.begin_object();
    write_member(json, "name", role.name);
    write_member(json, "namespace_uri", role.namespace_uri);
    json.name("identities");
    json.begin_list();
    for (const IdentityMappingRuleType& rule : role.identities) {
        json.begin_object();
        write_number(json, "criteria_type", static_cast<std::int32_t>(rule.criteria_type));
        write_member(json, "criteria", rule.criteria.view());
        json.end_object();
    }
    json.end_list();
    write_flag(json, "applications_exclude", role.applications_exclude);
    json.name("applications");
    json.begin_list();
    for (const std::string& uri : role.applications) {
        json.string(uri);
    }
    json.end_list();
    write_flag(json, "endpoints_exclude", role.endpoints_exclude);
    json.name("endpoints");
    json.begin_list();
    for (const EndpointType& endpoint : role.endpoints) {
        json.begin_object();
        write_member(json, "endpoint_url", endpoint.endpoint_url.view());
        write_number(json, "security_mode", static_cast<std::int32_t>(endpoint.security_mode));
        write_member(json, "security_policy_uri", endpoint.security_policy_uri.view());
        write_member(json, "transport_profile_uri", endpoint.transport_profile_uri.view());
        json.end_object();
    }
    json.end_list();
    json.end_object();
}

/// An error in a role of the file.
struct Wrong {
    std::string_view member;
    std::string_view expected;
};

template <typename T>
using Read = Expected<T, Wrong>;

Read<IdentityMappingRuleType> identity_of(const Json& json, const RoleLimits& limits)
{
    const auto type = number_of(json, "criteria_type");
    const std::string* const criteria = text_of(json, "criteria");
    if (!type || criteria == nullptr) {
        return Unexpected{Wrong{"identities", "a list of rules"}};
    }
    const IdentityMappingRuleType rule{static_cast<IdentityCriteriaType>(*type), String{*criteria}};
    if (check_rule(rule, limits.max_text).is_bad()) {
        return Unexpected{Wrong{"identities", "rules that can be used"}};
    }
    return rule;
}

Read<EndpointType> endpoint_of(const Json& json)
{
    const std::string* const url = text_of(json, "endpoint_url");
    const auto mode = number_of(json, "security_mode");
    const std::string* const policy = text_of(json, "security_policy_uri");
    const std::string* const transport = text_of(json, "transport_profile_uri");
    if (url == nullptr || !mode || *mode > 3 || policy == nullptr || transport == nullptr) {
        return Unexpected{Wrong{"endpoints", "a list of endpoints"}};
    }
    return EndpointType{String{*url}, static_cast<MessageSecurityMode>(*mode), String{*policy},
                        String{*transport}};
}

Read<std::string> application_of(const Json& json)
{
    if (json.kind != Json::Kind::String) {
        return Unexpected{Wrong{"applications", "a list of ApplicationUris"}};
    }
    return json.text;
}

template <typename T, typename ReadOne>
std::optional<Wrong> read_list(const Json& role, std::string_view name, const RoleLimits& limits,
                               std::vector<T>& to, ReadOne read_one)
{
    const Json* const list = list_of(role, name);
    if (list == nullptr || list->items.size() > limits.max_rules) {
        return Wrong{name, "a list within the limit"};
    }
    to.clear();
    for (const Json& item : list->items) {
        auto one = read_one(item);
        if (!one) {
            return one.error();
        }
        to.push_back(*std::move(one));
    }
    return std::nullopt;
}

std::optional<Wrong> read_rules(const Json& json, const RoleLimits& limits, RoleRules& role)
{
    const auto applications_exclude = flag_of(json, "applications_exclude");
    const auto endpoints_exclude = flag_of(json, "endpoints_exclude");
    if (!applications_exclude || !endpoints_exclude) {
        return Wrong{applications_exclude ? "endpoints_exclude" : "applications_exclude",
                     "true or false"};
    }
    role.applications_exclude = *applications_exclude;
    role.endpoints_exclude = *endpoints_exclude;
    if (auto wrong = read_list(json, "identities", limits, role.identities,
                               [&](const Json& item) { return identity_of(item, limits); })) {
        return wrong;
    }
    if (auto wrong = read_list(json, "applications", limits, role.applications, application_of)) {
        return wrong;
    }
    return read_list(json, "endpoints", limits, role.endpoints, endpoint_of);
}

std::optional<Wrong> read_role(const Json& json, const RoleLimits& limits,
                               std::vector<RoleRules>& roles)
{
    const std::string* const name = text_of(json, "name");
    const std::string* const uri = text_of(json, "namespace_uri");
    if (name == nullptr || name->empty() || uri == nullptr) {
        return Wrong{name == nullptr || name->empty() ? "name" : "namespace_uri", "a text"};
    }
    auto found = std::find_if(roles.begin(), roles.end(),
                              [&](const RoleRules& role) { return role.name == *name; });
    if (found == roles.end()) {
        if (roles.size() >= limits.max_roles) {
            return Wrong{"name", "no more roles than the limit"};
        }
        RoleRules role;
        role.name = *name;
        role.namespace_uri = *uri;
        roles.push_back(std::move(role));
        found = roles.end() - 1;
    } else if (found->namespace_uri != *uri) {
        return Wrong{"namespace_uri", "each name once"};
    }
    return read_rules(json, limits, *found);
}

} // namespace

std::string document_of(const std::vector<RoleRules>& roles)
{
    JsonWriter json;
    json.begin_object();
    write_number(json, "version", static_cast<std::int32_t>(version));
    json.name("roles");
    json.begin_list();
    for (const RoleRules& role : roles) {
        write_role(json, role);
    }
    json.end_list();
    json.end_object();
    return json.take() + "\n";
}

Configured<std::vector<RoleRules>> read_roles(Storage& storage, std::string_view file,
                                              const RoleLimits& limits)
{
    std::vector<RoleRules> roles = well_known_roles();
    const auto json = read_json_file(storage, file, version);
    if (!json || !*json) {
        return json ? Configured<std::vector<RoleRules>>{std::move(roles)}
                    : Unexpected{json.error()};
    }
    const Json* const list = list_of(**json, "roles");
    if (list == nullptr) {
        return Unexpected{wrong_member(storage, file, "roles", (*json)->find("roles"), "a list")};
    }
    for (std::size_t i = 0; i < list->items.size(); ++i) {
        if (const auto wrong = read_role(list->items[i], limits, roles)) {
            return Unexpected{wrong_member(
                storage, file, "roles[" + std::to_string(i) + "]." + std::string{wrong->member},
                list->items[i].find(wrong->member), wrong->expected)};
        }
    }
    // A file cannot change the meaning of these.
    const std::vector<RoleRules> known = well_known_roles();
    for (std::size_t i = 0; i < 3; ++i) {
        roles[i] = known[i];
    }
    return roles;
}

} // namespace busbar::administration::detail
