#pragma once

#include <string>

#include <busbar/crypto/self_signed.hpp>

#include "openssl.hpp"

/// The common parts of self-signed certificates and certificate requests (Part 6, 6.2.2).
namespace busbar::crypto::detail {

/// Returns the subjectAltName in OpenSSL's syntax: the ApplicationUri, then every name and address.
/// Bad_InvalidArgument if one of them is not allowed there.
[[nodiscard]] Result<std::string> alternative_names(const CertificateSubject& subject);

/// Returns false if a field is too long or has characters that it must not have (RFC 5280, A.1).
[[nodiscard]] bool add_fields(X509_NAME* name, const CertificateSubject& subject);

/// Returns an extension with a value in OpenSSL's syntax; null if it cannot be created.
[[nodiscard]] Extension make_extension(X509V3_CTX& context, int id, const std::string& value);

inline constexpr const char* basic_constraints = "critical,CA:FALSE";
/// For an RSA key; a self-signed certificate has keyCertSign as well.
inline constexpr const char* key_usage =
    "critical,digitalSignature,nonRepudiation,keyEncipherment,dataEncipherment";
inline constexpr const char* extended_key_usage = "serverAuth,clientAuth";

} // namespace busbar::crypto::detail
