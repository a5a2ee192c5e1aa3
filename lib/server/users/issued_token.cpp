#include "token_checks.hpp"

#include <busbar/core/text.hpp>
#include <busbar/crypto/jwt.hpp>

namespace busbar::server::detail {

Login log_in_issued(const LoginContext& context, const IssuedIdentityToken& token)
{
    if (auto failure = check_policy(context, UserTokenType::IssuedToken, token.policy_id)) {
        return Unexpected{*std::move(failure)};
    }
    if (!has_right_encryption(context, token.token_data, token.encryption_algorithm)) {
        return Unexpected{misuse(status::Bad_IdentityTokenInvalid,
                                 "the token is not encrypted as the endpoint says", {})};
    }
    const auto secret =
        open_secret(context, token.token_data, crypto::max_jwt_size, crypto::max_jwt_size);
    if (!secret) {
        return Unexpected{guess(status::Bad_IdentityTokenRejected, "issued token",
                                "it is not encrypted for this session", "Part 4, 7.40.6")};
    }
    const crypto::JwtRules* const rules = context.users->token_rules();
    if (rules == nullptr) {
        return Unexpected{
            misuse(status::Bad_IdentityTokenRejected, "there are no rules any more", {})};
    }
    auto claims =
        crypto::verify_jwt(secret->text(), *rules, context.config.application_uri, context.now);
    if (!claims) {
        const StatusCode status = claims.error().status;
        return Unexpected{LoginFailure{status, std::move(claims.error()), true}};
    }
    auto rights = context.users->token_user(*claims);
    if (!rights) {
        return Unexpected{
            guess(status::Bad_IdentityTokenRejected, "issued token",
                  "\"" + printable(claims->subject) + "\" is not a user of this server",
                  "Part 4, 7.40.6", "Add it to the users")};
    }
    UserIdentity user =
        identity_of(UserTokenType::IssuedToken, std::move(claims->subject), *std::move(rights));
    user.issuer = std::move(claims->issuer);
    user.claimed_roles = std::move(claims->roles);
    const auto skew = rules->clock_skew.count();
    user.valid_until = {claims->expires.ticks + skew * DateTime::ticks_per_second};
    return user;
}

} // namespace busbar::server::detail
