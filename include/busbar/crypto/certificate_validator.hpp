#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::crypto {

/// What a peer's certificate is checked for.
struct ValidationContext {
    const SecurityPolicy* policy{nullptr};
    DateTime now;
    /// Not empty: the certificate must name this ApplicationUri.
    std::string_view application_uri;
};

/// Decides whether a peer's certificate is accepted (Part 4, 6.1.3).
class CertificateValidator {
public:
    CertificateValidator() = default;
    CertificateValidator(const CertificateValidator&) = delete;
    CertificateValidator& operator=(const CertificateValidator&) = delete;
    virtual ~CertificateValidator() = default;

    /// `chain` is not empty, its leaf first. The status is one of Part 4, 6.1.3, table 100; the
    /// channel shows the peer Bad_SecurityChecksFailed for all but the few it may show.
    [[nodiscard]] virtual Result<void> validate(const CertificateChain& chain,
                                                const ValidationContext& context) = 0;
};

/// The checks that need no trust list: structure, key size, time, usage, ApplicationUri.
[[nodiscard]] Result<void> check_certificate(const Certificate& leaf,
                                             const ValidationContext& context);

/// Accepts whatever is well formed. For tests and the marked demo only.
class InsecureAcceptAnyCertificate final : public CertificateValidator {
public:
    [[nodiscard]] Result<void> validate(const CertificateChain& chain,
                                        const ValidationContext& context) override;
};

/// Trust lists as folders: `trusted`, `issuers` and `rejected` in `folder`, one certificate a file
/// (PEM or DER). Read at every validation, so that a moved file counts at once.
///
/// A certificate is trusted if it, or one that signed it, lies in `trusted`; certificates in
/// `issuers` only complete chains. What is not trusted is saved in `rejected`, at most
/// max_rejected files. Revocation lists are not read.
class TrustFolder final : public CertificateValidator {
public:
    static constexpr std::size_t max_rejected = 50;

    TrustFolder(std::string folder, LogSink& log) : folder_{std::move(folder)}, log_{&log} {}

    /// Makes the folders that are missing; Bad_ConfigurationError if that fails.
    [[nodiscard]] Result<void> create();
    [[nodiscard]] Result<void> validate(const CertificateChain& chain,
                                        const ValidationContext& context) override;

private:
    void save_rejected(const Certificate& leaf);

    std::string folder_;
    LogSink* log_;
};

} // namespace busbar::crypto
