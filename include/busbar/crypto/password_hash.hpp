#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/random.hpp>

namespace busbar::crypto {

/// The function that makes guessing of passwords slow.
enum class PasswordScheme : std::uint8_t {
    Scrypt, // RFC 7914: guessing takes memory, too
    Pbkdf2, // RFC 8018 with HMAC-SHA-256: for machines with too little memory for Scrypt
};

/// The cost of making and checking the hash of a password, and thereby of each guess. The default
/// takes 16.8 MB.
struct PasswordCost {
    PasswordScheme scheme{PasswordScheme::Scrypt};
    /// For Scrypt: the logarithm of N, 1 to 15; r, 1 to 8; p, 1 to 4. Memory grows with N and r,
    /// time with all of them.
    std::uint32_t log_n{14};
    std::uint32_t r{8};
    std::uint32_t p{1};
    /// For Pbkdf2: 1,000 to 10,000,000.
    std::uint32_t iterations{600'000};

    friend bool operator==(const PasswordCost&, const PasswordCost&) = default;
};

/// Returns the bytes that one call of hash_password or verify_password needs while it runs; 0 for a
/// cost out of range, for which they do nothing.
[[nodiscard]] BUSBAR_API std::uint64_t memory_of(const PasswordCost& cost);

/// Returns a password in the form in which it may be stored, with its numbers in decimal, salt and
/// hash in base64: "$scrypt$<log2 N>$<r>$<p>$<salt>$<hash>" or
/// "$pbkdf2-sha256$<iterations>$<salt>$<hash>". Bad_InvalidArgument for a cost out of range,
/// Bad_ResourceUnavailable without random numbers or memory.
[[nodiscard]] BUSBAR_API Result<std::string>
hash_password(std::string_view password, Random& random, const PasswordCost& cost = {});
/// True if `stored` is the hash of `password`, whatever it costs. False for a text that is not a
/// hash, or one whose cost is out of range.
[[nodiscard]] BUSBAR_API bool verify_password(std::string_view password, std::string_view stored);
/// Returns the cost of verify_password with `stored`; nothing if that always returns false.
[[nodiscard]] BUSBAR_API std::optional<PasswordCost> cost_of(std::string_view stored);
/// True if verify_password can use `stored`.
[[nodiscard]] BUSBAR_API bool is_password_hash(std::string_view stored);

} // namespace busbar::crypto
