#pragma once

#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::crypto {

/// Decides by the present lists of a store on the disk (see check_chain for the rules). The
/// certificate of a peer that is not trusted, whose issuers are unknown, or that was revoked is
/// saved in `rejected`, for the administrator to examine and perhaps to move.
///
/// The caller logs the refusal; suppressed failures are logged here. One thread at a time, as for
/// the store.
class BUSBAR_API StoreValidator final : public CertificateValidator {
public:
    /// `store` and `log` must outlive this object.
    StoreValidator(CertificateStore& store, LogSink& log, const ValidationSettings& settings = {});

    [[nodiscard]] Checked<void> validate(const CertificateChain& chain,
                                         const ValidationContext& context) override;
    /// The failures in the last validate() that a setting suppressed.
    [[nodiscard]] const std::vector<Refusal>& suppressed() const { return suppressed_; }

private:
    CertificateStore* store_;
    LogSink* log_;
    ValidationSettings settings_;
    std::vector<Refusal> suppressed_;
};

} // namespace busbar::crypto
