#pragma once

#include <optional>
#include <string>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/secret.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

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

} // namespace busbar::product
