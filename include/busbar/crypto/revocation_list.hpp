#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>

// OpenSSL's X509_CRL, which no public header includes.
struct X509_crl_st;

namespace busbar::crypto {

/// One certificate revocation list (Part 6, 6.2.5; RFC 5280, 5). Immutable; copies share.
///
/// It need not be genuine: call is_signed_by before relying on it.
class BUSBAR_API RevocationList {
public:
    static constexpr std::size_t max_size = 1'048'576; // bytes of DER

    /// Parses exactly one DER list of at most max_size bytes; Bad_CertificateInvalid for anything
    /// else.
    [[nodiscard]] static Result<RevocationList> parse(std::span<const std::byte> der);
    /// Parses PEM or DER, as in files.
    [[nodiscard]] static Result<RevocationList> parse_file(std::span<const std::byte> contents);

    [[nodiscard]] std::span<const std::byte> der() const { return *der_; }
    /// SHA-1 of the DER form in upper-case hexadecimal, for file names.
    [[nodiscard]] std::string thumbprint_text() const;
    /// The issuer's name for people: "CN=Name, O=...".
    [[nodiscard]] std::string issuer() const;
    [[nodiscard]] DateTime this_update() const;
    /// Null if the list does not say.
    [[nodiscard]] DateTime next_update() const;
    /// Number of revoked certificates.
    [[nodiscard]] std::size_t size() const;
    /// False for delta lists, partial and indirect lists and those with unknown critical
    /// extensions: they say too little about a certificate (RFC 5280, 5.2).
    [[nodiscard]] bool is_complete() const { return is_complete_; }

    /// Returns whether the list names this issuer; costs nothing and proves nothing.
    [[nodiscard]] bool names_issuer(const Certificate& issuer) const;
    /// Returns whether `issuer` signed the list and may do so (keyUsage cRLSign, unless there is no
    /// keyUsage). One RSA verification.
    [[nodiscard]] bool is_signed_by(const Certificate& issuer) const;
    /// The time at which the certificate, which must be of the list's issuer, was revoked; nullopt
    /// if it was not. Searches in logarithmic time.
    [[nodiscard]] std::optional<DateTime> revoked_at(const Certificate& certificate) const;

    [[nodiscard]] X509_crl_st* native() const { return crl_.get(); }

    friend bool operator==(const RevocationList& a, const RevocationList& b)
    {
        return *a.der_ == *b.der_;
    }

private:
    RevocationList(std::shared_ptr<X509_crl_st> crl, std::vector<std::byte> der);

    std::shared_ptr<X509_crl_st> crl_;
    std::shared_ptr<const std::vector<std::byte>> der_;
    bool is_complete_;
};

} // namespace busbar::crypto
