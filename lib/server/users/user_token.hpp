#pragma once

#include <memory>
#include <span>
#include <variant>

#include <busbar/core/expected.hpp>

#include <busbar/core/extension_object.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/session.hpp>

#include "password_checks.hpp"

namespace busbar::server::detail {

/// The reason why a login failed: the part for the client, and all of it for the log.
struct LoginFailure {
    StatusCode answer;
    Refusal refusal;
    /// It may be a guess: the failure counts, and is to be answered slowly.
    bool is_guess{false};
};

using Login = Expected<UserIdentity, LoginFailure>;

struct LoginContext;
/// log_in_issued() of token_checks.hpp, in a server that has it.
using IssuedLogin = Login(const LoginContext& context, const IssuedIdentityToken& token);

/// The context of log_in in addition to the token.
struct LoginContext {
    const ServerConfig& config;
    /// One of the configuration's endpoints.
    const EndpointConfig& endpoint;
    /// May be null.
    UserStore* users;
    /// The last nonce of the session.
    std::span<const std::byte> server_nonce;
    DateTime now;
    /// Null if issued tokens are not supported.
    IssuedLogin* log_in_issued{nullptr};
};

/// A login whose password must be checked: check->run(), which takes time, then end_log_in().
using LoginStep = std::variant<Login, std::shared_ptr<PasswordCheck>>;

/// Returns the user of a UserIdentityToken (Part 4, 7.40); a null token is anonymous. `signature`
/// is the userTokenSignature, which proves the possession of a user certificate.
///
/// - Bad_IdentityTokenInvalid: it does not have the form that its policy requires.
/// - Bad_IdentityTokenRejected: a kind of token that is not accepted here, a user certificate that
///   is not trusted, an issued token that is invalid.
/// - Bad_UserSignatureInvalid: the signature was not made with the key of the user certificate.
/// - Bad_UserAccessDenied: any failure that a guess at a password can cause: the secret does not
///   decrypt, was encrypted for another session, is too long, empty or wrong. Every one of them
///   costs the same work, a decryption and a password check.
[[nodiscard]] LoginStep begin_log_in(const LoginContext& context, const ExtensionObject& token,
                                     const SignatureData& signature);
[[nodiscard]] Login end_log_in(PasswordCheck& check);
/// Performs both, and the check between them.
[[nodiscard]] Login log_in(const LoginContext& context, const ExtensionObject& token,
                           const SignatureData& signature);

} // namespace busbar::server::detail
