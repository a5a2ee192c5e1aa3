#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/crypto/secret.hpp>

#include "user_token.hpp"

/// What the kinds of tokens are checked for alike.
namespace busbar::server::detail {

/// The client does not ask for what this endpoint offers: nobody is guessing.
[[nodiscard]] LoginFailure misuse(StatusCode status, std::string found, std::string remedy);
[[nodiscard]] LoginFailure guess(StatusCode status, std::string_view check, std::string found,
                                 std::string_view rule, std::string remedy = {});

/// Whether the endpoint accepts the kind of token, and the token names the policy for it.
[[nodiscard]] std::optional<LoginFailure> check_policy(const LoginContext& context,
                                                       UserTokenType type, const String& policy);

/// True if the secret of a token is encrypted, or not, as the endpoint wants it; which anyone can
/// see. With an EncryptedSecret `algorithm` says nothing (Part 4, 7.40.4).
[[nodiscard]] bool has_right_encryption(const LoginContext& context, const ByteString& secret,
                                        const String& algorithm);

/// The secret of a token as it was before encryption, in either format (Part 4, 7.40.2); nothing if
/// it cannot be read, is not for this session or has more bytes than `max_size`, in the legacy
/// format `max_legacy_size`.
[[nodiscard]] std::optional<crypto::Secret> open_secret(const LoginContext& context,
                                                        const ByteString& data,
                                                        std::size_t max_legacy_size,
                                                        std::size_t max_size);

[[nodiscard]] UserIdentity identity_of(UserTokenType type, std::string name, UserRights rights);

} // namespace busbar::server::detail
