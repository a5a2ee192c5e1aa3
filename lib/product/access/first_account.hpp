#pragma once

#include <optional>
#include <string>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/secret.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The account of a controller that nobody has configured yet.
struct FirstAccount {
    Account account;
    /// When it was made just now: to be shown once, on a terminal, and kept nowhere.
    std::optional<crypto::Secret> password;
};

/// "operator", with the hash in the file operator.password below `folder`; none if that is not
/// there. Throws ConfigError if it cannot be read or is no hash.
[[nodiscard]] std::optional<FirstAccount> load_first_account(const std::string& folder);

/// The same with a new random password, whose hash is saved for its owner alone. Throws
/// ConfigError.
[[nodiscard]] FirstAccount make_first_account(const std::string& folder, crypto::Random& random,
                                              const crypto::PasswordCost& cost);

/// 100 random bits as "xxxxx-xxxxx-xxxxx-xxxxx". Throws ConfigError.
[[nodiscard]] crypto::Secret new_password(crypto::Random& random);

} // namespace busbar::product
