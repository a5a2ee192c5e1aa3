#pragma once

#include <optional>
#include <string>
#include <vector>

#include <openssl/types.h>

#include <busbar/crypto/private_key.hpp>

/// Certificates of every kind, right and wrong, made by the tests themselves.
namespace busbar::test {

/// 2026-01-01T00:00:00Z; certificates are valid for 100 days to either side.
inline constexpr DateTime now = DateTime::from_unix_seconds(1'767'225'600);
[[nodiscard]] constexpr DateTime in_days(std::int64_t days)
{
    return {now.ticks + days * 86'400 * DateTime::ticks_per_second};
}

struct CertificateOptions {
    std::string common_name{"leaf"};
    std::string names{"URI:urn:test:leaf,DNS:plc.example,IP:192.0.2.7"}; // "": no subjectAltName
    std::string basic_constraints{"critical,CA:FALSE"};
    std::string key_usage{
        "critical,digitalSignature,nonRepudiation,keyEncipherment,dataEncipherment"};
    std::string extended_key_usage{"serverAuth,clientAuth"};
    std::string name_constraints{};
    std::string extra{};        // one more extension, as DER of OID 1.2.3.4, critical
    bool key_identifiers{true}; // subjectKeyIdentifier and authorityKeyIdentifier
    long version{2};            // 2: X.509 version 3
    long serial{0};             // 0: a new one
    DateTime valid_from{in_days(-100)};
    DateTime valid_to{in_days(100)};
    const char* digest{"SHA256"};
};

[[nodiscard]] CertificateOptions authority(const std::string& name);

/// A certificate and its private key.
struct Issued {
    crypto::Certificate certificate;
    crypto::PrivateKey key;
};

/// Keys are slow to make: one for each number, kept for the whole run.
[[nodiscard]] const crypto::PrivateKey& key_number(std::size_t number, std::uint32_t bits = 2048);

/// Signed by `issuer`, or by itself.
[[nodiscard]] Issued issue(const CertificateOptions& options, const crypto::PrivateKey& key,
                           const Issued* issuer = nullptr);

/// A self-signed certificate with an RSA public key of these numbers (hexadecimal), signed by
/// another key.
[[nodiscard]] std::vector<std::byte> der_with_public_key(const std::string& modulus,
                                                         const std::string& exponent);
[[nodiscard]] std::string random_modulus(int bits, bool is_odd);

/// The key as encrypted PKCS#8, PEM or DER.
[[nodiscard]] std::vector<std::byte> encrypted_key(const crypto::PrivateKey& key,
                                                   const std::string& passphrase, bool as_pem);
[[nodiscard]] std::vector<std::byte> plain_der_key(const crypto::PrivateKey& key);
[[nodiscard]] std::vector<std::byte> pem_of(const crypto::Certificate& certificate);

/// Returns a copy of what was written to a BIO in memory.
[[nodiscard]] std::vector<std::byte> contents_of(BIO* bio);

} // namespace busbar::test
