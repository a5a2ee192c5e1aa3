#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/crypto/trust_list.hpp>

namespace busbar::crypto {

/// The purpose that a certificate is checked for.
enum class CertificatePurpose : std::uint8_t {
    Application, // a server or a client
    ServerApplication,
    ClientApplication,
    User, // X509IdentityToken: no host name, no ApplicationUri (Part 6, 6.2.3)
};

/// The requirements that a peer's certificate is checked against.
struct ValidationContext {
    /// If null or None, key lengths and signature algorithms are not checked.
    const SecurityPolicy* policy{nullptr};
    DateTime now;
    /// If not empty, the certificate must name this ApplicationUri, and no other.
    std::string_view application_uri;
    /// If not empty, the certificate must name this host or address, which a client knows from the
    /// server's URL.
    std::string_view host_name{};
    CertificatePurpose purpose{CertificatePurpose::Application};
    /// The origin of the peer, such as a network's address: each origin has a share of what is kept
    /// of unknown peers. Empty if unknown.
    std::string_view source{};
};

/// The steps of Part 4, 6.1.3, Table 100 that an administrator may suppress; the others always
/// apply. Suppressed steps are still checked, and reported (see check_chain).
struct ValidationSettings {
    bool suppress_security_policy_check{false};  // Bad_CertificatePolicyCheckFailed
    bool suppress_validity_period{false};        // Bad_CertificateTimeInvalid
    bool suppress_issuer_validity_period{false}; // Bad_CertificateIssuerTimeInvalid
    bool suppress_host_name{false};              // Bad_CertificateHostNameInvalid
    /// Bad_CertificateUseNotAllowed, unless the certificate marks its usage as critical. The usage
    /// of a CA is never suppressed: any application could issue certificates then.
    bool suppress_certificate_usage{false};
    bool suppress_find_revocation_list{false};        // Bad_CertificateRevocationUnknown
    bool suppress_find_issuer_revocation_list{false}; // Bad_CertificateIssuerRevocationUnknown
};

/// Limits of one validation, whatever the peer sends and the trust list holds: a path has at most
/// max_chain_length certificates, and at most this many signatures of certificates and revocation
/// lists are verified. None is verified before the names lead from the leaf to a root.
inline constexpr std::size_t max_signature_checks = 32;

/// Performs Part 4, 6.1.3, Table 100, step by step and in its order, over the path from the leaf to
/// a root. The path is built from `chain` (the leaf first, the others in any order), `list.trusted`
/// and `list.issuers`. A certificate is trusted if it or a CA above it is in `list.trusted`. The
/// newest revocation list of every CA on the path must be there, complete and current; a
/// self-signed leaf needs none.
///
/// Returns nothing if the certificate is accepted, else the first step that failed. `suppressed`,
/// if not null, gets the failures that a setting suppressed; Part 4 asks for an audit event for
/// each. Pure: logs and saves nothing. Called from any thread.
[[nodiscard]] BUSBAR_API std::optional<Refusal>
check_chain(const CertificateChain& chain, const TrustList& list, const ValidationContext& context,
            const ValidationSettings& settings = {}, std::vector<Refusal>* suppressed = nullptr);

/// Checks whether a trust list is consistent (Part 12, 7.8.2.5): every trusted certificate except
/// CAs must pass check_chain with this list, regardless of what an administrator may suppress.
/// Returns the refusal of the first one that does not.
[[nodiscard]] BUSBAR_API std::optional<Refusal>
check_trust_list(const TrustList& list, DateTime now, CertificatePurpose purpose);

/// True for a certificate that may sign others: basicConstraints say so (RFC 5280, 4.2.1.9).
[[nodiscard]] BUSBAR_API bool is_authority(const Certificate& certificate);

/// Decides whether a peer's certificate is accepted (Part 4, 6.1.3).
class BUSBAR_API CertificateValidator {
public:
    CertificateValidator() = default;
    CertificateValidator(const CertificateValidator&) = delete;
    CertificateValidator& operator=(const CertificateValidator&) = delete;
    virtual ~CertificateValidator() = default;

    /// `chain` is not empty; its leaf comes first. The refusal's status is one of Part 4, 6.1.3,
    /// Table 100. The caller writes it to the log, and tells the peer Bad_SecurityChecksFailed
    /// except for the few that a peer may see.
    [[nodiscard]] virtual Checked<void> validate(const CertificateChain& chain,
                                                 const ValidationContext& context) = 0;
};

/// Performs the steps of the table that need neither issuers nor trust list: structure, policy,
/// validity, host name, ApplicationUri, usage. The leaf counts as a trusted root; its signature is
/// not verified.
[[nodiscard]] BUSBAR_API Checked<void> check_certificate(const Certificate& leaf,
                                                         const ValidationContext& context);

/// Accepts every certificate with a key that the policy allows. For tests and the marked demo only.
class BUSBAR_API InsecureAcceptAnyCertificate final : public CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const CertificateChain& chain,
                                         const ValidationContext& context) override;
};

} // namespace busbar::crypto
