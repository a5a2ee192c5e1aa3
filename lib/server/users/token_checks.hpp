#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/session.hpp>

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

/// Returns the user of an IssuedIdentityToken with a JSON Web Token (Part 4, 7.40.6; Part 6,
/// 6.5.2). Failures are those of begin_log_in.
[[nodiscard]] Login log_in_issued(const LoginContext& context, const IssuedIdentityToken& token);

/// Returns the bytes that are signed for a certificate and a nonce: the one followed by the other
/// (Part 4, 7.36).
[[nodiscard]] std::vector<std::byte> join(std::span<const std::byte> certificate,
                                          std::span<const std::byte> nonce);

/// True if the key of `signer` has signed the server's certificate and nonce by the policy (Part 4,
/// 5.7.3.2). Never with SecurityPolicy None.
[[nodiscard]] bool is_signed(const channel::ApplicationIdentity& server,
                             const crypto::SecurityPolicy& policy,
                             const crypto::Certificate& signer,
                             std::span<const std::byte> server_nonce,
                             const SignatureData& signature);

} // namespace busbar::server::detail
