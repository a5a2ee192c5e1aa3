#pragma once

#include <optional>

#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/password_users.hpp>

namespace busbar::product {

/// Application setup (Part 12, G.2): a controller without administrator lets in the user "setup"
/// with a code that it printed once, to make one. Meanwhile any client may connect, and whom that
/// user has added may log in from it too.
///
/// On the server's thread.
class Setup final : public crypto::CertificateValidator {
public:
    static constexpr const char* user_name = "setup";
    static constexpr const char* code_file = "setup.code";

    /// Not active. `inner` decides about clients.
    Setup(Storage& files, crypto::CertificateValidator& inner, server::PasswordUsers& users)
        : files_{files}, inner_{inner}, users_{users}
    {
    }

    /// Lets the user in. The code, if it was made just now: to be shown once, and kept nowhere; its
    /// hash, which costs `cost`, is in the file setup.code. Throws ConfigError.
    [[nodiscard]] std::optional<crypto::Secret> begin(crypto::Random& random,
                                                      const crypto::PasswordCost& cost);
    [[nodiscard]] bool is_active() const { return is_active_; }
    /// For good: no such user, no such file, and strangers are strangers again.
    void end();

    /// A client that is not trusted may connect while the setup lasts; nothing else is let pass.
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override;

private:
    Storage& files_;
    crypto::CertificateValidator& inner_;
    server::PasswordUsers& users_;
    bool is_active_{false};
};

} // namespace busbar::product
