#pragma once

#include <optional>
#include <string>

#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/password_users.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Application setup (Part 12, G.2): a controller without an administrator admits the user "setup"
/// with a code that it printed once, in order to create one. In the meantime any client may
/// connect, and users whom "setup" has added may log in from it, too.
///
/// Used on the server's thread.
class Setup final : public crypto::CertificateValidator {
public:
    static constexpr const char* user_name = "setup";
    static constexpr const char* code_file = "setup.code";

    /// Not active yet. `inner` decides about clients.
    Setup(Storage& files, crypto::CertificateValidator& inner, server::PasswordUsers& users)
        : files_{files}, inner_{inner}, users_{users}
    {
    }

    /// Takes a new code back that was not shown.
    ~Setup() override;

    /// Admits the user. Returns the code if it is new: show it once, call code_is_shown(), and
    /// store it nowhere; the file setup.code has its hash, which costs `cost`. Throws ConfigError,
    /// and then there is no file that was not there before.
    [[nodiscard]] std::optional<crypto::Secret> begin(crypto::Random& random,
                                                      const crypto::PasswordCost& cost);
    /// Keeps the new code for further starts.
    void code_is_shown() { takes_code_back_ = false; }
    [[nodiscard]] bool is_active() const { return is_active_; }
    /// Ends the setup for good: removes the user and the file, and refuses untrusted clients again.
    /// If that fails half way, which throws, another call does the rest.
    void end();

    /// Lets a client that is not trusted connect while the setup lasts; all other checks apply.
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override;

private:
    /// Returns the hash in the file; nothing if there is no file. Throws ConfigError.
    [[nodiscard]] std::optional<std::string> kept_hash() const;

    Storage& files_;
    crypto::CertificateValidator& inner_;
    server::PasswordUsers& users_;
    bool is_active_{false};
    bool has_code_{false}; // there is a file
    bool takes_code_back_{false};
};

/// The account of a controller that has not been configured yet.
struct FirstAccount {
    Account account;
    /// Set if the password is new: show it once, on a terminal, and store it nowhere.
    std::optional<crypto::Secret> password;
};

/// Loads "operator", whose hash is in the file operator.password in `folder`; nothing if the file
/// does not exist. Throws ConfigError if it cannot be read or does not contain a hash.
[[nodiscard]] std::optional<FirstAccount> load_first_account(const std::string& folder);

/// Makes the account with a new random password, and saves its hash for its owner alone. Throws
/// ConfigError.
[[nodiscard]] FirstAccount make_first_account(const std::string& folder, crypto::Random& random,
                                              const crypto::PasswordCost& cost);

/// Makes 100 random bits as "xxxxx-xxxxx-xxxxx-xxxxx". Throws ConfigError.
[[nodiscard]] crypto::Secret new_password(crypto::Random& random);

/// Implements --hash-password: reads a password from standard input and prints its hash for a
/// configuration. The cost is that in [users] of `config_file`, which may otherwise be invalid; ""
/// is the built-in configuration. Returns the program's exit code; throws ConfigError.
[[nodiscard]] int hash_password(const std::string& config_file);

} // namespace busbar::product
