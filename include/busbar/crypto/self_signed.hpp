#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>

namespace busbar::crypto {

/// Twenty years, five of them leap years.
inline constexpr std::uint32_t default_valid_days = 20 * 365 + 5;

/// The content of an ApplicationInstanceCertificate (Part 6, 6.2.2). The fields of the
/// distinguished name are those of Part 12, 7.9.4, and the certificate has them in this order;
/// empty ones are left out. Lengths are those of RFC 5280, A.1: 64 characters, 128 for locality and
/// state, exactly two for the country.
struct CertificateSubject {
    std::string common_name{};  // never empty
    std::string organization{}; // runs the application; required by Part 6, 6.2.2
    std::string organizational_unit{};
    std::string locality{};
    std::string state{};
    std::string country{};
    std::string domain_component{};
    std::string application_uri{}; // never empty
    std::vector<std::string> dns_names{};
    std::vector<std::string> ip_addresses{};
    DateTime valid_from{};
    std::uint32_t valid_days{default_valid_days};
};

/// Adds `host` to the DNS names or to the addresses, depending on its form.
BUSBAR_API void add_host(CertificateSubject& subject, const std::string& host);

/// Returns what a certificate says about its owner, without times.
[[nodiscard]] BUSBAR_API CertificateSubject subject_of(const Certificate& certificate);

/// Creates a certificate that is its own issuer, signed with SHA-256, for a server and a client; it
/// is not a CA. Bad_InvalidArgument if a name, address or time cannot be used in a certificate.
[[nodiscard]] BUSBAR_API Result<Certificate> create_self_signed(const PrivateKey& key,
                                                                const CertificateSubject& subject);

} // namespace busbar::crypto
