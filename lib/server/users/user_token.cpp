#include "user_token.hpp"

#include <optional>

#include <busbar/core/text.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/session.hpp>

#include "token_checks.hpp"
#include "user_policies.hpp"

namespace busbar::server::detail {

namespace {

/// Maximum number of bytes of a password; the legacy format has room for 64 (Part 4, 7.40.2.1).
constexpr std::size_t max_password_size = 256;
/// Checked instead of a password that could not be read.
constexpr std::string_view stand_in = "not the password of anyone";

Login log_in_anonymous(const LoginContext& context, const String& policy)
{
    // A client that omits the token omits the policy (Part 4, 5.7.3.2).
    const String named = policy.empty() ? String{"anonymous"} : policy;
    if (auto failure = check_policy(context, UserTokenType::Anonymous, named)) {
        return Unexpected{*std::move(failure)};
    }
    UserIdentity user = context.users != nullptr ? context.users->anonymous() : anonymous_reader();
    user.token_type = UserTokenType::Anonymous;
    return user;
}

LoginStep begin_user(const LoginContext& context, const UserNameIdentityToken& token)
{
    if (auto failure = check_policy(context, UserTokenType::UserName, token.policy_id)) {
        return Login{Unexpected{*std::move(failure)}};
    }
    if (token.user_name.empty() ||
        !has_right_encryption(context, token.password, token.encryption_algorithm)) {
        return Login{Unexpected{misuse(status::Bad_IdentityTokenInvalid,
                                       "there is no name, or the password is not encrypted as "
                                       "the endpoint says",
                                       {})}};
    }
    auto secret = open_secret(context, token.password, crypto::max_secret_size, max_password_size);
    auto check = std::make_shared<PasswordCheck>();
    check->name = token.user_name.view();
    // Neither answer nor time tells what was wrong: the password check is made in any case.
    check->is_readable = secret && !secret->empty();
    check->password = check->is_readable ? *std::move(secret) : crypto::Secret{stand_in};
    return check;
}

/// Checks the certificate's own trust list, then the proof that the user has its key.
std::optional<LoginFailure> check_certificate_user(const LoginContext& context,
                                                   const crypto::CertificateChain& chain,
                                                   const SignatureData& signature)
{
    const crypto::SecurityPolicy& policy = certificate_policy(context.endpoint);
    crypto::ValidationContext validation;
    validation.policy = &policy;
    validation.now = context.now;
    validation.purpose = crypto::CertificatePurpose::User;
    crypto::CertificateValidator* const validator = context.users->certificate_validator();
    if (validator == nullptr) {
        return misuse(status::Bad_IdentityTokenRejected, "there is no validator any more", {});
    }
    auto trusted = validator->validate(chain, validation);
    if (!trusted) {
        return LoginFailure{status::Bad_IdentityTokenRejected, std::move(trusted.error()), true};
    }
    const auto& identity = context.config.identity;
    if (!identity ||
        !is_signed(*identity, policy, chain.front(), context.server_nonce, signature)) {
        LoginFailure failure =
            guess(status::Bad_UserSignatureInvalid, "user token signature",
                  "it was not made with the key of the user certificate over the server's "
                  "certificate and last nonce",
                  "Part 4, 5.7.3.2");
        failure.refusal.subject = printable(chain.front().subject());
        failure.refusal.thumbprint = chain.front().thumbprint_text();
        return failure;
    }
    return std::nullopt;
}

Login log_in_certificate(const LoginContext& context, const X509IdentityToken& token,
                         const SignatureData& signature)
{
    if (auto failure = check_policy(context, UserTokenType::Certificate, token.policy_id)) {
        return Unexpected{*std::move(failure)};
    }
    const auto chain = crypto::parse_chain(token.certificate_data.span());
    if (!chain) {
        return Unexpected{
            misuse(status::Bad_IdentityTokenInvalid, "the user certificate cannot be read", {})};
    }
    if (auto failure = check_certificate_user(context, *chain, signature)) {
        return Unexpected{*std::move(failure)};
    }
    const crypto::Certificate& certificate = chain->front();
    auto rights = context.users->certificate_user(certificate);
    if (!rights) {
        LoginFailure failure =
            guess(status::Bad_IdentityTokenRejected, "user certificate", "it belongs to no user",
                  "Part 4, 7.40.5", "Add it to the users");
        failure.refusal.subject = printable(certificate.subject());
        failure.refusal.thumbprint = certificate.thumbprint_text();
        return Unexpected{std::move(failure)};
    }
    UserIdentity user =
        identity_of(UserTokenType::Certificate, certificate.subject(), *std::move(rights));
    user.thumbprint = certificate.thumbprint_text();
    user.valid_until = certificate.valid_to();
    return user;
}

} // namespace

LoginStep begin_log_in(const LoginContext& context, const ExtensionObject& token,
                       const SignatureData& signature)
{
    if (token.is_null()) {
        return log_in_anonymous(context, {}); // Part 4, 5.7.3.2
    }
    if (const auto* anonymous = token.get_if<AnonymousIdentityToken>()) {
        return log_in_anonymous(context, anonymous->policy_id);
    }
    if (const auto* user = token.get_if<UserNameIdentityToken>()) {
        return begin_user(context, *user);
    }
    if (const auto* certificate = token.get_if<X509IdentityToken>()) {
        return log_in_certificate(context, *certificate, signature);
    }
    const auto* issued = token.get_if<IssuedIdentityToken>();
    if (issued != nullptr && context.log_in_issued != nullptr) {
        return context.log_in_issued(context, *issued);
    }
    return Login{
        Unexpected{misuse(status::Bad_IdentityTokenInvalid, "it is not a UserIdentityToken", {})}};
}

Login end_log_in(PasswordCheck& check)
{
    if (!check.thrown.view().empty()) { // which means nothing about the user
        return Unexpected{misuse(status::Bad_InternalError,
                                 "UserStore::log_in threw: " + printable(check.thrown.view()), {})};
    }
    if (!check.is_readable || !check.result) {
        return Unexpected{guess(
            status::Bad_UserAccessDenied, "user name and password",
            "user \"" + printable(check.name) + "\": " +
                (check.is_readable ? "no such user, or another password"
                                   : "the password is empty, or not encrypted for this session"),
            "Part 4, 7.40.4")};
    }
    check.result->token_type = UserTokenType::UserName;
    return *std::move(check.result);
}

Login log_in(const LoginContext& context, const ExtensionObject& token,
             const SignatureData& signature)
{
    LoginStep step = begin_log_in(context, token, signature);
    if (auto* login = std::get_if<Login>(&step)) {
        return std::move(*login);
    }
    PasswordCheck& check = *std::get<std::shared_ptr<PasswordCheck>>(step);
    check.run(*context.users);
    return end_log_in(check);
}

} // namespace busbar::server::detail
