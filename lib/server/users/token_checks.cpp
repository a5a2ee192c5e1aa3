#include "token_checks.hpp"

#include <busbar/core/text.hpp>
#include <busbar/crypto/encrypted_secret.hpp>

#include "user_policies.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::string_view name_of(UserTokenType type)
{
    switch (type) {
    case UserTokenType::Anonymous:
        return "anonymous users";
    case UserTokenType::UserName:
        return "user names";
    case UserTokenType::Certificate:
        return "user certificates";
    case UserTokenType::IssuedToken:
        return "issued tokens";
    }
    return {};
}

} // namespace

LoginFailure misuse(StatusCode status, std::string found, std::string remedy)
{
    return {status,
            {status, "user token policy", std::move(found), "Part 4, 7.40.1", std::move(remedy)}};
}

LoginFailure guess(StatusCode status, std::string_view check, std::string found,
                   std::string_view rule, std::string remedy)
{
    return {status, {status, check, std::move(found), rule, std::move(remedy)}, true};
}

std::optional<LoginFailure> check_policy(const LoginContext& context, UserTokenType type,
                                         const String& policy)
{
    if (!accepts(context.endpoint, context.users, type)) {
        return misuse(status::Bad_IdentityTokenRejected,
                      std::string{name_of(type)} + " are not accepted at this endpoint",
                      "To accept them, allow them in the configuration of the endpoint");
    }
    const std::string expected = policy_id(context.endpoint, type);
    if (policy.view() != expected) {
        return misuse(status::Bad_IdentityTokenInvalid,
                      "the token names the policy \"" + printable(policy.view()) + "\" and not \"" +
                          expected + "\"",
                      "The client has to read the endpoints again");
    }
    return std::nullopt;
}

bool has_right_encryption(const LoginContext& context, const ByteString& secret,
                          const String& algorithm)
{
    const crypto::SecurityPolicy& policy = password_policy(context.endpoint);
    if (policy.is_none()) {
        return algorithm.empty();
    }
    return context.config.identity && (algorithm.view() == policy.encryption_uri ||
                                       crypto::is_encrypted_secret(secret.span()));
}

std::optional<crypto::Secret> open_secret(const LoginContext& context, const ByteString& data,
                                          std::size_t max_legacy_size, std::size_t max_size)
{
    const crypto::SecurityPolicy& policy = password_policy(context.endpoint);
    if (policy.is_none()) {
        return data.size() <= max_size ? std::optional{crypto::Secret{data.span()}} : std::nullopt;
    }
    const channel::ApplicationIdentity& identity = *context.config.identity;
    auto secret = crypto::is_encrypted_secret(data.span())
                      ? crypto::unseal_secret(policy, identity.certificates.front(), identity.key,
                                              data.span(), context.server_nonce, max_size)
                      : crypto::decrypt_secret(policy, identity.key, data.span(),
                                               context.server_nonce, max_legacy_size);
    return secret ? std::optional{*std::move(secret)} : std::nullopt;
}

UserIdentity identity_of(UserTokenType type, std::string name, UserRights rights)
{
    UserIdentity user;
    user.token_type = type;
    user.name = std::move(name);
    user.access_level_mask = rights.access_level_mask;
    user.roles = std::move(rights.roles);
    user.administers_only = rights.administers_only;
    return user;
}

} // namespace busbar::server::detail
