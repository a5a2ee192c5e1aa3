#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/secret.hpp>

struct evp_pkey_st;

/// JSON Web Tokens (RFC 7519) as issued user tokens (Part 6, 6.5.2). Called from any thread.
namespace busbar::crypto {

/// JWS algorithms (RFC 7518, 3.1). There is no "none", and there are no others.
enum class JwtAlgorithm : std::uint8_t { RS256, PS256, ES256, HS256 };

/// Returns the name as it is in the header of a token.
[[nodiscard]] BUSBAR_API std::string_view name(JwtAlgorithm algorithm);

/// A key that tokens may be signed with, and the only algorithm it is used for: a token with
/// another algorithm is refused, whatever key it names (RFC 8725, 3.1). Immutable; copies share.
class BUSBAR_API JwtKey {
public:
    /// Takes the public key of an RSA (2048 bits or more) or P-256 certificate or PEM public key.
    /// Bad_ConfigurationError if it is something else, or not a key for the algorithm. `id` is the
    /// `kid` that tokens name it by; empty if they do not.
    [[nodiscard]] static Result<JwtKey>
    from_public_key(JwtAlgorithm algorithm, std::span<const std::byte> pem, std::string id = {});
    [[nodiscard]] static Result<JwtKey>
    from_certificate(JwtAlgorithm algorithm, const Certificate& certificate, std::string id = {});
    /// Uses HS256 with a secret of 32 bytes or more. A party that can verify such tokens can also
    /// create them, which Part 6, 6.5.2.3 does not provide for: for closed plants only.
    [[nodiscard]] static Result<JwtKey> from_shared_secret(std::span<const std::byte> secret,
                                                           std::string id = {});

    [[nodiscard]] JwtAlgorithm algorithm() const { return algorithm_; }
    [[nodiscard]] const std::string& id() const { return id_; }
    /// True if the key belongs to the signature of the text.
    [[nodiscard]] bool verify(std::string_view signed_text,
                              std::span<const std::byte> signature) const;

private:
    JwtKey(JwtAlgorithm algorithm, std::string id) : algorithm_{algorithm}, id_{std::move(id)} {}

    JwtAlgorithm algorithm_;
    std::string id_;
    std::shared_ptr<evp_pkey_st> key_;
    std::shared_ptr<const Secret> secret_;
};

/// The rules that a token must fulfil.
struct JwtRules {
    /// At most max_jwt_keys are tried for one token.
    std::vector<JwtKey> keys;
    /// The `iss` that a token must have. If empty, tokens must have none.
    std::string issuer;
    /// The value that `aud` must have or contain: the resourceId. If empty, the server's
    /// ApplicationUri.
    std::string audience;
    /// Maximum error of the issuer's clock.
    std::chrono::seconds clock_skew{60};
    /// A token that is valid for longer than this from now on is refused.
    std::chrono::seconds max_lifetime{std::chrono::hours{24}};
};

/// The limits of a token, and of what it is checked with.
inline constexpr std::size_t max_jwt_size = 8'192; // bytes
inline constexpr std::size_t max_jwt_keys = 8;
inline constexpr std::size_t max_jwt_roles = 64;

/// The content of a verified token (Part 6, Table 56).
struct JwtClaims {
    std::string subject; // `sub`
    std::string issuer;  // `iss`
    std::string name;    // a person's name, for display
    /// Names as in the token: roles of Part 18 or the issuer's own.
    std::vector<std::string> roles;
    DateTime issued_at; // null if missing
    DateTime expires;
};

/// Returns the claims of a token in JWS Compact Serialization. One of the keys must verify its
/// signature, and it must be meant for `rules.audience` (`application_uri` if that is empty) and
/// valid at `now`. `sub`, `aud` and `exp` are mandatory (Part 6, 6.5.2.3); `nbf` and `iat` are
/// checked if present.
///
/// Bad_IdentityTokenInvalid for anything that is not such a token, Bad_IdentityTokenRejected for
/// one that is not accepted here or now. The refusal says why and contains nothing of the token
/// except printable claims. Claims are not read before the signature is verified. Bounded work for
/// any text.
[[nodiscard]] BUSBAR_API Checked<JwtClaims> verify_jwt(std::string_view token,
                                                       const JwtRules& rules,
                                                       std::string_view application_uri,
                                                       DateTime now);

} // namespace busbar::crypto
