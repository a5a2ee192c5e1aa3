#include "user_policies.hpp"

#include <busbar/crypto/jwt.hpp>

#include "core/json_writer.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::string_view jwt_type = "http://opcfoundation.org/UA/UserToken#JWT";

/// Returns the issuerEndpointUrl of a policy for JSON Web Tokens (Part 6, 6.5.2.2, Table 55).
std::string issuer_parameters(const ServerConfig& config, const crypto::JwtRules& rules)
{
    const TokenIssuer& issuer = config.issuer;
    busbar::detail::JsonWriter json;
    const auto add = [&](std::string_view name, std::string_view value) {
        json.name(name);
        json.string(value);
    };
    const auto add_list = [&](std::string_view name, const std::vector<std::string>& values) {
        json.name(name);
        json.begin_list();
        for (const std::string& value : values) {
            json.string(value);
        }
        json.end_list();
    };
    json.begin_object();
    add("ua:resourceId", rules.audience.empty() ? config.application_uri : rules.audience);
    add("ua:authorityUrl", issuer.authority_url);
    add("ua:authorityProfileUri", issuer.authority_profile_uri);
    if (!issuer.token_endpoint.empty()) {
        add("ua:tokenEndpoint", issuer.token_endpoint);
    }
    if (!issuer.authorization_endpoint.empty()) {
        add("ua:authorizationEndpoint", issuer.authorization_endpoint);
    }
    if (!issuer.request_types.empty()) {
        add_list("ua:requestTypes", issuer.request_types);
    }
    if (!issuer.scopes.empty()) {
        add_list("ua:scopes", issuer.scopes);
    }
    json.end_object();
    return json.take();
}

} // namespace

const crypto::SecurityPolicy& password_policy(const EndpointConfig& endpoint)
{
    if (endpoint.password_policy != nullptr) {
        return *endpoint.password_policy;
    }
    if (!endpoint.security.policy->is_none()) {
        return *endpoint.security.policy;
    }
    const auto* policy = crypto::find_policy_by_name("Basic256Sha256");
    return policy != nullptr ? *policy : crypto::policy_none();
}

const crypto::SecurityPolicy& certificate_policy(const EndpointConfig& endpoint)
{
    return endpoint.certificate_policy != nullptr ? *endpoint.certificate_policy
                                                  : password_policy(endpoint);
}

bool accepts(const EndpointConfig& endpoint, UserStore* users, UserTokenType type)
{
    switch (type) {
    case UserTokenType::Anonymous:
        return endpoint.allows_anonymous;
    case UserTokenType::UserName:
        return endpoint.allows_user_name && users != nullptr;
    case UserTokenType::Certificate:
        return endpoint.allows_certificate && users != nullptr &&
               users->certificate_validator() != nullptr;
    case UserTokenType::IssuedToken:
        return endpoint.allows_issued && users != nullptr && users->token_rules() != nullptr;
    }
    return false;
}

std::string policy_id(const EndpointConfig& endpoint, UserTokenType type)
{
    switch (type) {
    case UserTokenType::UserName:
        return "username_" + std::string{password_policy(endpoint).name};
    case UserTokenType::Certificate:
        return "certificate_" + std::string{certificate_policy(endpoint).name};
    case UserTokenType::IssuedToken:
        return "issued_" + std::string{password_policy(endpoint).name};
    case UserTokenType::Anonymous:
        break;
    }
    return "anonymous";
}

std::vector<UserTokenPolicy> token_policies(const ServerConfig& config,
                                            const EndpointConfig& endpoint, UserStore* users)
{
    std::vector<UserTokenPolicy> policies;
    for (const UserTokenType type : {UserTokenType::Anonymous, UserTokenType::UserName,
                                     UserTokenType::Certificate, UserTokenType::IssuedToken}) {
        if (!accepts(endpoint, users, type)) {
            continue;
        }
        UserTokenPolicy& policy = policies.emplace_back();
        policy.policy_id = policy_id(endpoint, type);
        policy.token_type = type;
        if (type == UserTokenType::Certificate) {
            policy.security_policy_uri = certificate_policy(endpoint).uri;
        } else if (type != UserTokenType::Anonymous) {
            policy.security_policy_uri = password_policy(endpoint).uri;
        }
        if (type == UserTokenType::IssuedToken) {
            policy.issued_token_type = jwt_type;
            policy.issuer_endpoint_url = issuer_parameters(config, *users->token_rules());
        }
    }
    return policies;
}

} // namespace busbar::server::detail
