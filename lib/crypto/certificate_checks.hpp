#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/revocation_list.hpp>
#include <busbar/crypto/trust_list.hpp>

/// The steps of Part 4, 6.1.3, Table 100, each for one certificate of a path.

namespace busbar::crypto::detail {

/// Verifies the signatures of one validation: at most max_signature_checks, none of them twice.
class SignatureChecks {
public:
    /// Returns false also when all checks are used up.
    [[nodiscard]] bool is_signed_by(const Certificate& certificate, const Certificate& issuer);
    [[nodiscard]] bool is_signed_by(const RevocationList& list, const Certificate& issuer);
    [[nodiscard]] std::size_t count() const { return done_.size(); }
    [[nodiscard]] bool is_used_up() const;

private:
    struct Check {
        const void* what; // X509 or X509_CRL
        const x509_st* issuer;
        bool is_good;
    };

    template <typename Verify>
    bool once(const void* what, const Certificate& issuer, Verify verify);

    std::vector<Check> done_;
};

/// A validation in progress: the path from the leaf to a root and the requirements.
struct Validation {
    const CertificateChain& path;
    const TrustList& list;
    const ValidationContext& context;
    SignatureChecks& signatures;

    /// True at the end of a path of several certificates.
    [[nodiscard]] bool is_at_root(std::size_t index) const
    {
        return index != 0 && index + 1 == path.size();
    }
};

/// The objection of a step to a certificate.
struct Finding {
    std::string found;
    std::string remedy;
    bool is_mandatory{false}; // no setting can suppress it
};

/// `index` is the certificate's index in the path, 0 for the leaf.
using Check = std::optional<Finding> (*)(const Validation& validation, std::size_t index);

[[nodiscard]] std::optional<Finding> check_structure(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_policy(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_trust(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_validity(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_host_name(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_uri(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_usage(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_issuer_usage(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> find_revocation_list(const Validation&, std::size_t index);
[[nodiscard]] std::optional<Finding> check_revocation(const Validation&, std::size_t index);

[[nodiscard]] bool is_root(const Certificate& certificate);
[[nodiscard]] bool is_trusted(const Certificate& certificate, const TrustList& list);
[[nodiscard]] bool is_valid_at(const Certificate& certificate, DateTime time);

/// Subject and thumbprint, for people.
[[nodiscard]] std::string label_of(const Certificate& certificate);
[[nodiscard]] Refusal refusal_of(StatusCode status, std::string_view step, Finding finding,
                                 const Certificate& culprit);

/// Returns the path from sent.front() to a root, inclusive, with good signatures only; or the
/// refusal of the steps "Build Certificate Chain" and "Signature" of Part 4, 6.1.3, Table 100. A
/// self-signed leaf is a path by itself.
///
/// Issuers are searched first among the trusted certificates, then among the issuers, then among
/// the sent ones; of each, those that are valid at `now` first. A path with a trusted certificate
/// is preferred to one without.
[[nodiscard]] Checked<CertificateChain> find_path(const CertificateChain& sent,
                                                  const TrustList& list, DateTime now,
                                                  SignatureChecks& signatures);

} // namespace busbar::crypto::detail
