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

/// Why a login failed: what the client may know, and all of it for the log.
struct LoginFailure {
    StatusCode answer;
    Refusal refusal;
    /// Somebody may be guessing: the failure counts, and is to be answered slowly.
    bool is_guess{false};
};

using Login = Expected<UserIdentity, LoginFailure>;

struct LoginContext;
/// log_in_issued() of issued_token.hpp, in a server that has it.
using IssuedLogin = Login(const LoginContext& context, const IssuedIdentityToken& token);

/// What log_in needs besides the token.
struct LoginContext {
    const ServerConfig& config;
    /// One of its endpoints.
    const EndpointConfig& endpoint;
    /// May be null.
    UserStore* users;
    /// The last one that the session was given.
    std::span<const std::byte> server_nonce;
    DateTime now;
    /// Null where issued tokens are none.
    IssuedLogin* log_in_issued{nullptr};
};

/// A login whose password is to be checked: check->run(), which takes its time, then end_log_in().
using LoginStep = std::variant<Login, std::shared_ptr<PasswordCheck>>;

/// The user that a UserIdentityToken stands for (Part 4, 7.40); a null token is anonymous.
/// `signature` is the userTokenSignature, which proves the possession of a user certificate.
///
/// - Bad_IdentityTokenInvalid: it has not the form that its policy asks for.
/// - Bad_IdentityTokenRejected: a kind of token that is not accepted here, a user certificate that
///   is not trusted, an issued token that does not count.
/// - Bad_UserSignatureInvalid: the signature was not made with the key of the user certificate.
/// - Bad_UserAccessDenied: all that a guess at a password can come to, be it that the secret does
///   not decrypt, was encrypted for another session, is too long, empty or wrong. Every one of them
///   costs the same work, a decryption and a password check.
[[nodiscard]] LoginStep begin_log_in(const LoginContext& context, const ExtensionObject& token,
                                     const SignatureData& signature);
[[nodiscard]] Login end_log_in(PasswordCheck& check);
/// Both, and the check between them.
[[nodiscard]] Login log_in(const LoginContext& context, const ExtensionObject& token,
                           const SignatureData& signature);

} // namespace busbar::server::detail
