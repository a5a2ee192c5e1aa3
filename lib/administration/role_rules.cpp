#include "role_rules.hpp"

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/status_codes.hpp>

#include "json_file.hpp"

namespace busbar::administration::detail {

namespace {

using Pairs = std::vector<std::string>;

constexpr std::size_t thumbprint_size = 40;

/// Splits a distinguished name at any of `separators` outside quotes; removes quotes, backslashes
/// and the blanks around each part.
Pairs parts_of(std::string_view text, std::string_view separators)
{
    Pairs parts(1);
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\\' && i + 1 < text.size()) {
            parts.back() += text[++i];
        } else if (text[i] == '"') {
            is_quoted = !is_quoted;
        } else if (!is_quoted && separators.find(text[i]) != std::string_view::npos) {
            parts.emplace_back();
        } else if (is_quoted || text[i] != ' ' || !parts.back().empty()) {
            parts.back() += text[i];
        }
    }
    for (std::string& part : parts) {
        part.erase(part.find_last_not_of(' ') + 1);
    }
    return parts;
}

bool is_pair(const std::string& part)
{
    const std::size_t sign = part.find('=');
    return sign != std::string::npos && sign != 0 && sign + 1 < part.size();
}

/// True if the subject, written as by Certificate::subject, has every pair of the rule.
bool is_subject(std::string_view rule, std::string_view subject)
{
    const Pairs wanted = parts_of(rule, "/");
    const Pairs there = parts_of(subject, ",+");
    return std::all_of(wanted.begin(), wanted.end(), [&](const std::string& pair) {
        return std::find(there.begin(), there.end(), pair) != there.end();
    });
}

bool has(const std::vector<std::string>& list, std::string_view text)
{
    return std::find(list.begin(), list.end(), text) != list.end();
}

bool fits(const IdentityMappingRuleType& rule, const server::RoleQuestion& question)
{
    const server::UserIdentity& user = question.user;
    const std::string_view criteria = rule.criteria.view();
    switch (rule.criteria_type) {
    case IdentityCriteriaType::UserName:
        return user.token_type == UserTokenType::UserName && user.name == criteria;
    case IdentityCriteriaType::Thumbprint:
        return user.token_type == UserTokenType::Certificate && user.thumbprint == criteria;
    case IdentityCriteriaType::Role:
        return user.token_type == UserTokenType::IssuedToken && has(user.claimed_roles, criteria);
    case IdentityCriteriaType::Anonymous:
        return user.token_type == UserTokenType::Anonymous;
    case IdentityCriteriaType::AuthenticatedUser:
        return user.token_type != UserTokenType::Anonymous;
    case IdentityCriteriaType::Application:
        return question.is_trusted && question.application_uri == criteria;
    case IdentityCriteriaType::X509Subject:
        return user.token_type == UserTokenType::Certificate && is_subject(criteria, user.name);
    case IdentityCriteriaType::TrustedApplication:
        return question.is_trusted;
    default:
        return false;
    }
}

/// Compares endpoints; empty and zero fields of the rule are ignored (Part 18, 4.4.2).
bool fits(const EndpointType& endpoint, const server::RoleQuestion& question)
{
    const auto is_same = [](const String& wanted, std::string_view there) {
        return wanted.empty() || wanted.view() == there;
    };
    return is_same(endpoint.endpoint_url, question.endpoint_url) &&
           (endpoint.security_mode == MessageSecurityMode::Invalid ||
            endpoint.security_mode == question.security_mode) &&
           is_same(endpoint.security_policy_uri, question.security_policy_uri) &&
           is_same(endpoint.transport_profile_uri,
                   "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary");
}

} // namespace

bool fits(const RoleRules& role, const server::RoleQuestion& question)
{
    return admits(role, question) &&
           std::any_of(role.identities.begin(), role.identities.end(),
                       [&](const IdentityMappingRuleType& rule) { return fits(rule, question); });
}

bool admits(const RoleRules& role, const server::RoleQuestion& question)
{
    // An ApplicationUri that is not proven by a certificate never matches the list.
    const bool is_listed = question.is_trusted && has(role.applications, question.application_uri);
    const bool is_listed_endpoint =
        std::any_of(role.endpoints.begin(), role.endpoints.end(),
                    [&](const EndpointType& endpoint) { return fits(endpoint, question); });
    // A list of excluded applications also excludes any without a proven ApplicationUri.
    const bool is_excluded = role.applications_exclude && !role.applications.empty() &&
                             (is_listed || !question.is_trusted);
    return !is_excluded && (role.applications_exclude || is_listed) &&
           role.endpoints_exclude != is_listed_endpoint;
}

StatusCode check_rule(const IdentityMappingRuleType& rule, std::size_t max_text)
{
    const std::string_view criteria = rule.criteria.view();
    if (criteria.size() > max_text || !is_kept_whole(criteria)) {
        return status::Bad_InvalidArgument;
    }
    const auto when = [](bool is_right) {
        return is_right ? status::Good : status::Bad_InvalidArgument;
    };
    switch (rule.criteria_type) {
    case IdentityCriteriaType::UserName:
    case IdentityCriteriaType::Role:
    case IdentityCriteriaType::Application:
        return when(!criteria.empty());
    case IdentityCriteriaType::Thumbprint:
        return when(criteria.size() == thumbprint_size &&
                    criteria.find_first_not_of("0123456789ABCDEF") == std::string_view::npos);
    case IdentityCriteriaType::Anonymous:
    case IdentityCriteriaType::AuthenticatedUser:
    case IdentityCriteriaType::TrustedApplication:
        return when(criteria.empty());
    case IdentityCriteriaType::X509Subject: {
        const Pairs pairs = parts_of(criteria, "/");
        return when(std::all_of(pairs.begin(), pairs.end(), is_pair));
    }
    case IdentityCriteriaType::GroupId:
        return status::Bad_NotSupported;
    default:
        return status::Bad_InvalidArgument;
    }
}

} // namespace busbar::administration::detail
