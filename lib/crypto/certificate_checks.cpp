#include "certificate_checks.hpp"

#include <algorithm>

#include <openssl/err.h>

#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

constexpr std::string_view another_certificate = "The peer needs another certificate";

bool is_rsa_with_strong_digest(const Certificate& certificate, bool allows_sha1)
{
    int digest = NID_undef;
    int key = NID_undef;
    if (X509_get_signature_info(certificate.native(), &digest, &key, nullptr, nullptr) != 1) {
        return false;
    }
    return (key == NID_rsaEncryption || key == NID_rsassaPss) &&
           (digest == NID_sha256 || digest == NID_sha384 || digest == NID_sha512 ||
            (allows_sha1 && digest == NID_sha1));
}

std::optional<Finding> check_key_size(const Certificate& certificate, const SecurityPolicy& policy,
                                      bool is_leaf)
{
    const std::uint32_t bits = certificate.key_bits(); // 0 for an issuer's key that is not RSA
    const bool is_wrong =
        bits != 0 && (bits < policy.min_key_bits || (is_leaf && bits > policy.max_key_bits));
    if (!is_wrong) {
        return std::nullopt;
    }
    return Finding{"its key has " + std::to_string(bits) + " bits where " +
                       std::string{policy.name} + " asks for " +
                       std::to_string(policy.min_key_bits) + " to " +
                       std::to_string(policy.max_key_bits),
                   std::string{another_certificate} + ", or another security policy"};
}

/// Returns the content of a name extension of the leaf, shortened for the log.
std::string joined(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text.empty() ? "none" : printable(text);
}

} // namespace

/// Part 6, 6.2.2: version 3; an application and a user have an RSA key, as every policy here
/// requires. RFC 5280, 4.2: no unknown critical extension.
std::optional<Finding> check_structure(const Validation& validation, std::size_t index)
{
    const Certificate& certificate = validation.path[index];
    const std::uint32_t flags = X509_get_extension_flags(certificate.native());
    ERR_clear_error();
    const char* found = nullptr;
    if (index == 0 && certificate.key_bits() == 0) {
        found = "its key is not an RSA key";
    } else if (X509_get_version(certificate.native()) != X509_VERSION_3) {
        found = "it is not an X.509 version 3 certificate";
    } else if ((flags & EXFLAG_CRITICAL) != 0) {
        found = "it has an unknown critical extension";
    } else if ((flags & (EXFLAG_INVALID | EXFLAG_PROXY)) != 0) {
        found = "its extensions contradict each other or are malformed";
    }
    if (found == nullptr) {
        return std::nullopt;
    }
    return Finding{found, std::string{another_certificate}};
}

/// Part 7, 6.6: the policies' key lengths and CertificateSignatureAlgorithm; longer digests than
/// SHA-256 are not weaker.
std::optional<Finding> check_policy(const Validation& validation, std::size_t index)
{
    const SecurityPolicy* const policy = validation.context.policy;
    if (policy == nullptr || policy->is_none()) {
        return std::nullopt;
    }
    const Certificate& certificate = validation.path[index];
    if (auto finding = check_key_size(certificate, *policy, index == 0)) {
        return finding;
    }
    // The signature of a root under itself protects nothing.
    if (validation.is_at_root(index) ||
        is_rsa_with_strong_digest(certificate, policy->allows_sha1_certificates)) {
        return std::nullopt;
    }
    const char* algorithm = OBJ_nid2ln(X509_get_signature_nid(certificate.native()));
    return Finding{"it is signed with " +
                       std::string{algorithm != nullptr ? algorithm : "an unknown algorithm"} +
                       ", which " + std::string{policy->name} + " does not allow",
                   std::string{another_certificate} + ", signed with RSA and SHA-256"};
}

bool is_trusted(const Certificate& certificate, const TrustList& list)
{
    return std::find(list.trusted.begin(), list.trusted.end(), certificate) != list.trusted.end();
}

/// One certificate of the path is enough, the leaf or a CA.
std::optional<Finding> check_trust(const Validation& validation, std::size_t)
{
    const bool is_good = std::any_of(
        validation.path.begin(), validation.path.end(),
        [&](const Certificate& certificate) { return is_trusted(certificate, validation.list); });
    if (is_good) {
        return std::nullopt;
    }
    if (validation.path.size() == 1) {
        return Finding{"it is not among the trusted certificates",
                       "To trust it, move it from rejected to trusted"};
    }
    return Finding{"neither it nor a CA above it, up to " + label_of(validation.path.back()) +
                       ", is among the trusted certificates",
                   "To trust it alone, move it from rejected to trusted; to trust all of a CA, put "
                   "the CA's certificate there"};
}

bool is_valid_at(const Certificate& certificate, DateTime time)
{
    const DateTime from = certificate.valid_from();
    return !from.is_null() && from <= time && time <= certificate.valid_to();
}

std::optional<Finding> check_validity(const Validation& validation, std::size_t index)
{
    const Certificate& certificate = validation.path[index];
    const DateTime now = validation.context.now;
    if (is_valid_at(certificate, now)) {
        return std::nullopt;
    }
    const bool is_early = now < certificate.valid_from();
    return Finding{(is_early ? "not valid before " + to_string(certificate.valid_from())
                             : "expired " + to_string(certificate.valid_to())) +
                       ", now " + to_string(now),
                   "Renew it, or set this machine's clock"};
}

/// Part 4, 6.1.3: the same as one of the names in the certificate; no wildcards, no CommonName.
std::optional<Finding> check_host_name(const Validation& validation, std::size_t)
{
    const std::string host{validation.context.host_name};
    if (host.empty() || validation.context.purpose == CertificatePurpose::User) {
        return std::nullopt;
    }
    const Certificate& leaf = validation.path.front();
    constexpr unsigned flags = X509_CHECK_FLAG_NO_WILDCARDS | X509_CHECK_FLAG_NEVER_CHECK_SUBJECT;
    const bool matches =
        X509_check_host(leaf.native(), host.data(), host.size(), flags, nullptr) == 1 ||
        X509_check_ip_asc(leaf.native(), host.c_str(), 0) == 1;
    ERR_clear_error();
    if (matches) {
        return std::nullopt;
    }
    return Finding{"connected to " + printable(host) +
                       ", but its host names are: " + joined(leaf.host_names()),
                   "Connect by one of its names, or give the server a certificate with this one"};
}

/// Part 6, 6.2.2: one of its URIs, compared whole and exactly.
std::optional<Finding> check_uri(const Validation& validation, std::size_t)
{
    const std::string_view wanted = validation.context.application_uri;
    if (wanted.empty() || validation.context.purpose == CertificatePurpose::User) {
        return std::nullopt;
    }
    const Certificate& leaf = validation.path.front();
    if (leaf.is_of_application(wanted)) {
        return std::nullopt;
    }
    const auto uris = leaf.uris();
    return Finding{
        (uris.empty() ? "it names no ApplicationUri" : "its ApplicationUri is " + joined(uris)) +
            ", the ApplicationDescription's is " + printable(wanted),
        "Set the peer's ApplicationUri to that of its certificate, or give it another "
        "certificate"};
}

bool is_root(const Certificate& certificate)
{
    return X509_self_signed(certificate.native(), 0) == 1;
}

std::string label_of(const Certificate& certificate)
{
    return printable(certificate.subject()) + " (" + certificate.thumbprint_text() + ")";
}

Refusal refusal_of(StatusCode status, std::string_view step, Finding finding,
                   const Certificate& culprit)
{
    return {status,
            step,
            std::move(finding.found),
            "Part 4, 6.1.3, Table 100",
            std::move(finding.remedy),
            printable(culprit.subject()),
            culprit.thumbprint_text()};
}

} // namespace busbar::crypto::detail
