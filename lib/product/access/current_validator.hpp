#pragma once

#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::product {

/// Asks whoever decides now, for who cannot be given another validator later.
class CurrentValidator final : public crypto::CertificateValidator {
public:
    /// `validator` must outlive this, or the next call. Before the first validate().
    void use(crypto::CertificateValidator& validator) { validator_ = &validator; }

    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override
    {
        return validator_->validate(chain, context);
    }

private:
    crypto::CertificateValidator* validator_{nullptr};
};

} // namespace busbar::product
