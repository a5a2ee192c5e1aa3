#include "user_token.hpp"

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/session.hpp>

namespace busbar::server::detail {

namespace {

constexpr std::string_view anonymous_id = "anonymous";
/// Longer ones are not sent by the rules of Part 4, 7.41.4 for encrypted secrets.
constexpr std::size_t max_password_size = 64;

std::string user_name_id(const EndpointConfig& endpoint)
{
    return "username_" + std::string{password_policy(endpoint).name};
}

Result<UserIdentity> log_in_anonymous(const LoginContext& context, const String& policy_id)
{
    if (!context.endpoint.allows_anonymous) {
        return fail(status::Bad_IdentityTokenRejected);
    }
    if (!policy_id.empty() && policy_id.view() != anonymous_id) {
        return fail(status::Bad_IdentityTokenInvalid);
    }
    return context.users != nullptr ? context.users->anonymous() : anonymous_reader();
}

/// The password as text, of whatever size it is.
Result<crypto::Secret> decrypt_password(const LoginContext& context,
                                        const UserNameIdentityToken& token)
{
    const crypto::SecurityPolicy& policy = password_policy(context.endpoint);
    if (policy.is_none()) {
        if (!token.encryption_algorithm.empty()) {
            return fail(status::Bad_IdentityTokenInvalid);
        }
        return crypto::Secret{token.password.span()};
    }
    if (token.encryption_algorithm.view() != policy.encryption_uri || context.key == nullptr) {
        return fail(status::Bad_IdentityTokenInvalid);
    }
    auto secret =
        crypto::decrypt_secret(policy, *context.key, token.password.span(), context.server_nonce);
    if (!secret) {
        return fail(status::Bad_UserAccessDenied);
    }
    return secret;
}

Result<UserIdentity> log_in_user(const LoginContext& context, const UserNameIdentityToken& token)
{
    if (!context.endpoint.allows_user_name || context.users == nullptr) {
        return fail(status::Bad_IdentityTokenRejected);
    }
    if (token.policy_id.view() != user_name_id(context.endpoint) || token.user_name.empty()) {
        return fail(status::Bad_IdentityTokenInvalid);
    }
    const auto password = decrypt_password(context, token);
    if (!password) {
        return fail(password.error());
    }
    if (password->empty() || password->size() > max_password_size) {
        return fail(status::Bad_UserAccessDenied);
    }
    auto user = context.users->log_in(token.user_name.view(), password->text());
    if (!user) {
        return fail(status::Bad_UserAccessDenied);
    }
    return user;
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

std::vector<UserTokenPolicy> token_policies(const EndpointConfig& endpoint, bool has_users)
{
    std::vector<UserTokenPolicy> policies;
    if (endpoint.allows_anonymous) {
        UserTokenPolicy& policy = policies.emplace_back();
        policy.policy_id = anonymous_id;
        policy.token_type = UserTokenType::Anonymous;
    }
    if (endpoint.allows_user_name && has_users) {
        UserTokenPolicy& policy = policies.emplace_back();
        policy.policy_id = user_name_id(endpoint);
        policy.token_type = UserTokenType::UserName;
        policy.security_policy_uri = password_policy(endpoint).uri;
    }
    return policies;
}

Result<UserIdentity> log_in(const LoginContext& context, const ExtensionObject& token)
{
    if (token.is_null()) {
        return log_in_anonymous(context, {}); // Part 4, 5.6.3.2
    }
    if (const auto* anonymous = token.get_if<AnonymousIdentityToken>()) {
        return log_in_anonymous(context, anonymous->policy_id);
    }
    if (const auto* user = token.get_if<UserNameIdentityToken>()) {
        return log_in_user(context, *user);
    }
    const bool is_other_kind = token.get_if<X509IdentityToken>() != nullptr ||
                               token.get_if<IssuedIdentityToken>() != nullptr;
    return fail(is_other_kind ? status::Bad_IdentityTokenRejected
                              : status::Bad_IdentityTokenInvalid);
}

} // namespace busbar::server::detail
