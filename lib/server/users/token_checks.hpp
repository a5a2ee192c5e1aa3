#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/crypto/secret.hpp>

#include "user_token.hpp"

/// The common checks of all kinds of tokens.
namespace busbar::server::detail {

/// Returns the failure of a client that requests something this endpoint does not offer: it is not
/// a guess.
[[nodiscard]] LoginFailure misuse(StatusCode status, std::string found, std::string remedy);
[[nodiscard]] LoginFailure guess(StatusCode status, std::string_view check, std::string found,
                                 std::string_view rule, std::string remedy = {});

/// Checks that the endpoint accepts the kind of token, and that the token names the policy for it.
[[nodiscard]] std::optional<LoginFailure> check_policy(const LoginContext& context,
                                                       UserTokenType type, const String& policy);

/// True if the secret of a token is encrypted, or not, as the endpoint requires; anyone can see
/// that. With an EncryptedSecret `algorithm` is meaningless (Part 4, 7.40.4).
[[nodiscard]] bool has_right_encryption(const LoginContext& context, const ByteString& secret,
                                        const String& algorithm);

/// Returns the decrypted secret of a token in either format (Part 4, 7.40.2); nothing if it cannot
/// be read, is not for this session or exceeds `max_size` bytes, in the legacy format
/// `max_legacy_size`.
[[nodiscard]] std::optional<crypto::Secret> open_secret(const LoginContext& context,
                                                        const ByteString& data,
                                                        std::size_t max_legacy_size,
                                                        std::size_t max_size);

[[nodiscard]] UserIdentity identity_of(UserTokenType type, std::string name, UserRights rights);

} // namespace busbar::server::detail
