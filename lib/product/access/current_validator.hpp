#pragma once

#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::product {

/// Forwards to the present validator, for objects whose validator cannot be replaced.
class CurrentValidator final : public crypto::CertificateValidator {
public:
    /// Sets the validator; must be called before the first validate(). `validator` must outlive
    /// this object or the next call.
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
