#pragma once

#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/random.hpp>

namespace busbar::crypto {

/// Bytes that each call of hash_password or verify_password takes while it lasts; with a hash that
/// others made with larger numbers up to twice as many. So that guessing takes them too.
inline constexpr std::size_t password_hash_memory = 16'780'288;

/// A password as it may be stored: "$scrypt$<log2 N>$<r>$<p>$<salt>$<hash>" (RFC 7914), base64.
[[nodiscard]] BUSBAR_API Result<std::string> hash_password(std::string_view password,
                                                           Random& random);
/// True if `stored` is the hash of `password`. False for a text that is no hash, and for parameters
/// that would take more than 64 MiB.
[[nodiscard]] BUSBAR_API bool verify_password(std::string_view password, std::string_view stored);
/// True if verify_password can use `stored`.
[[nodiscard]] BUSBAR_API bool is_password_hash(std::string_view stored);

} // namespace busbar::crypto
