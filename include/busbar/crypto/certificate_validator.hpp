#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::crypto {

/// What a peer's certificate is checked for.
struct ValidationContext {
    const SecurityPolicy* policy{nullptr};
    DateTime now;
    /// Not empty: the certificate must name this ApplicationUri, and no other.
    std::string_view application_uri;
    /// Not empty: the certificate must name this host or address, which a client knows from the
    /// server's URL.
    std::string_view host_name{};
};

/// Decides whether a peer's certificate is accepted (Part 4, 6.1.3).
class CertificateValidator {
public:
    CertificateValidator() = default;
    CertificateValidator(const CertificateValidator&) = delete;
    CertificateValidator& operator=(const CertificateValidator&) = delete;
    virtual ~CertificateValidator() = default;

    /// `chain` is not empty, its leaf first. The refusal's status is one of Part 4, 6.1.3, Table
    /// 100; who asks writes it to the log, and shows the peer Bad_SecurityChecksFailed for all but
    /// the few it may show.
    [[nodiscard]] virtual Checked<void> validate(const CertificateChain& chain,
                                                 const ValidationContext& context) = 0;
};

/// The checks of a leaf that need neither chain nor trust list, in the order of the table:
/// structure, policy, time, host name, ApplicationUri, usage.
[[nodiscard]] Result<void> check_certificate(const Certificate& leaf,
                                             const ValidationContext& context);

/// Accepts whoever has a key that the policy allows. For tests and the marked demo only.
class InsecureAcceptAnyCertificate final : public CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const CertificateChain& chain,
                                         const ValidationContext& context) override;
};

/// Trust lists as folders: `trusted`, `issuers` and `rejected` in `folder`, one certificate a file
/// (PEM or DER). Looked at for every validation, so that a moved file counts at once; only files
/// that changed are read.
///
/// All steps of Part 4, 6.1.3, table 100, but revocation lists, which are not read. The chain is
/// built up to a root from what the peer sent and both lists; then one certificate of it, or more,
/// must lie in `trusted`. A leaf that is refused for want of trust is saved in `rejected`: at most
/// max_rejected files, the oldest goes; at most max_rejected_per_minute are written.
///
/// The log says which check failed on which certificate. One thread at a time.
class TrustFolder final : public CertificateValidator {
public:
    static constexpr std::size_t max_rejected = 50;
    static constexpr std::size_t max_rejected_per_minute = 10;

    /// `log` must outlive this.
    TrustFolder(std::string folder, LogSink& log);
    ~TrustFolder() override;

    /// Makes the folders that are missing; Bad_ConfigurationError if that fails.
    [[nodiscard]] Result<void> create();
    [[nodiscard]] Checked<void> validate(const CertificateChain& chain,
                                         const ValidationContext& context) override;

private:
    struct Folders;
    std::unique_ptr<Folders> folders_;
    LogSink* log_;
};

} // namespace busbar::crypto
