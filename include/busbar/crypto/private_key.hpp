#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/secret.hpp>

struct evp_pkey_st;

namespace busbar::crypto {

/// An RSA key pair. Immutable; copies share.
class PrivateKey {
public:
    /// PEM or DER, PKCS#1 or PKCS#8, the latter also encrypted. Bad_ConfigurationError if it is
    /// none of them, no RSA key or the passphrase is wrong. Never asks anyone.
    [[nodiscard]] static Result<PrivateKey> parse(std::span<const std::byte> contents,
                                                  std::string_view passphrase = {});
    /// A new key of 2048 to 4096 bits; else Bad_InvalidArgument.
    [[nodiscard]] static Result<PrivateKey> generate(std::uint32_t bits);

    /// PKCS#8 PEM, without a passphrase. For a file that only its owner may read.
    [[nodiscard]] Result<Secret> to_pem() const;
    /// The same in a file that only its owner may read, whole or not at all (see save_file).
    [[nodiscard]] Result<void> save(const std::string& path) const;
    [[nodiscard]] std::size_t key_size() const;
    /// True if this is the private half of the certificate's key.
    [[nodiscard]] bool belongs_to(const Certificate& certificate) const;

    [[nodiscard]] evp_pkey_st* native() const { return key_.get(); }

private:
    explicit PrivateKey(std::shared_ptr<evp_pkey_st> key) : key_{std::move(key)} {}

    std::shared_ptr<evp_pkey_st> key_;
};

/// What a self-signed ApplicationInstanceCertificate says (Part 6, 6.2.2).
struct CertificateSubject {
    std::string common_name;
    std::string organization;
    std::string application_uri;
    std::vector<std::string> dns_names;
    std::vector<std::string> ip_addresses;
    DateTime valid_from;
    std::uint32_t valid_days{365 * 5};
};

/// Bad_InvalidArgument if a name, address or time cannot stand in a certificate. Signed with
/// SHA-256; usable as server and as client.
[[nodiscard]] Result<Certificate> create_self_signed(const PrivateKey& key,
                                                     const CertificateSubject& subject);

} // namespace busbar::crypto
