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
#include <busbar/core/result.hpp>

// OpenSSL's X509, which no public header includes.
struct x509_st;

namespace busbar::crypto {

/// One X.509 v3 ApplicationInstanceCertificate (Part 6, 6.2.2). Immutable; copies share.
class BUSBAR_API Certificate {
public:
    /// Parses exactly one DER certificate of at most 16 KiB, whose key is valid and has at most
    /// 8192 bits; Bad_CertificateInvalid for anything else.
    [[nodiscard]] static Result<Certificate> parse(std::span<const std::byte> der);
    /// Parses PEM or DER, as in files.
    [[nodiscard]] static Result<Certificate> parse_file(std::span<const std::byte> contents);

    [[nodiscard]] std::span<const std::byte> der() const { return *der_; }
    /// SHA-1 of the DER form, 20 bytes (Part 6, 6.7.2.3).
    [[nodiscard]] std::vector<std::byte> thumbprint() const;
    /// The same in upper-case hexadecimal.
    [[nodiscard]] std::string thumbprint_text() const;
    /// "CN=Name, O=..." for people.
    [[nodiscard]] std::string subject() const;
    /// Returns the first URI of subjectAltName, unchanged; empty if there is none. Use `printable`
    /// to show it to people.
    [[nodiscard]] std::string application_uri() const;
    /// Returns whether one of the URIs of subjectAltName is exactly this ApplicationUri; there may
    /// be others beside it (Part 6, 6.2.2). False for an empty `uri`.
    [[nodiscard]] bool is_of_application(std::string_view uri) const;
    /// DNS names and IP addresses of subjectAltName.
    [[nodiscard]] std::vector<std::string> host_names() const;
    /// Returns all URIs of subjectAltName, unchanged.
    [[nodiscard]] std::vector<std::string> uris() const;
    [[nodiscard]] DateTime valid_from() const;
    [[nodiscard]] DateTime valid_to() const;
    /// Size of the RSA modulus; 0 for a key that is not RSA.
    [[nodiscard]] std::uint32_t key_bits() const;
    [[nodiscard]] std::size_t key_size() const { return (key_bits() + 7) / 8; }

    [[nodiscard]] x509_st* native() const { return x509_.get(); }

    friend bool operator==(const Certificate& a, const Certificate& b)
    {
        return *a.der_ == *b.der_;
    }

private:
    Certificate(std::shared_ptr<x509_st> x509, std::vector<std::byte> der);

    std::shared_ptr<x509_st> x509_;
    std::shared_ptr<const std::vector<std::byte>> der_;
};

/// A leaf certificate, followed by those that signed it (Part 6, 6.2.6).
using CertificateChain = std::vector<Certificate>;

/// The limits of a chain that a peer sends.
inline constexpr std::size_t max_chain_length = 10;
inline constexpr std::size_t max_chain_size = 65'536; // bytes of DER

/// Splits concatenated DER certificates. Bad_CertificateInvalid if there is none, if something else
/// is among them, or if they are more than max_chain_length or larger than max_chain_size.
/// Certificates that are among `known` are copied from there instead of being parsed.
[[nodiscard]] BUSBAR_API Result<CertificateChain>
parse_chain(std::span<const std::byte> der, std::span<const Certificate> known = {});

/// Keeps the latest certificates of peers, so that those of a returning peer need not be parsed
/// again: parsing takes OpenSSL as long as a signature with a private key. One thread.
class BUSBAR_API KnownCertificates {
public:
    static constexpr std::size_t max_count = 16;
    /// Maximum size of a certificate that is kept, in bytes of DER.
    static constexpr std::size_t max_size = 4'096;

    [[nodiscard]] std::span<const Certificate> certificates() const { return certificates_; }
    /// Keeps the certificates of a chain in place of the oldest ones; those that are kept already
    /// count as new. Keep only trusted ones, or unknown peers displace them.
    void keep(const CertificateChain& chain);

private:
    std::vector<Certificate> certificates_; // the oldest first
};

/// Returns a thumbprint, or the beginning of one, as people write it, in the spelling of
/// thumbprint_text().
[[nodiscard]] BUSBAR_API std::string spelled_thumbprint(std::string_view text);

} // namespace busbar::crypto
