#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/crypto/password_hash.hpp>

namespace busbar::server {

/// Characters that names and passwords may be limited to.
inline constexpr std::string_view letters_and_digits =
    "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
inline constexpr std::string_view letters_digits_and_underscore =
    "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ_abcdefghijklmnopqrstuvwxyz";

/// The rules for names and passwords of users, and the cost of password hashes. They apply when a
/// user is added or a password changed, never at a login: a login must not disclose the rules, and
/// passwords from before a change of the rules stay valid.
///
/// The default requires length, not kinds of characters, and is limited by what every client can
/// send: 64 bytes in the legacy format (Part 4, 7.40.2.1).
struct PasswordRules {
    // Minimum lengths are in characters, maximum lengths in bytes of UTF-8; both are inclusive.

    std::size_t min_name_length{1};
    std::size_t max_name_length{64};
    std::size_t min_password_length{12};
    std::size_t max_password_length{64};
    /// The only allowed characters; if empty, all except control characters.
    std::string name_characters{};
    std::string password_characters{};
    /// A password needs an upper-case letter, a lower-case letter and a digit.
    bool needs_letters_and_digit{false};
    /// Names that no user can have, in any case.
    std::vector<std::string> reserved_names{};
    std::size_t max_users{1'000};
    /// The cost of new hashes; existing ones keep theirs.
    crypto::PasswordCost cost{};
};

/// Names of 4 to 32 and passwords of 8 to 32 letters and digits, six reserved names, 20 users. The
/// same for nj501 and nx102.
[[nodiscard]] BUSBAR_API PasswordRules nj501_password_rules();
/// Passwords of 6 to 32 letters, digits and underscores with an upper-case letter, a lower-case
/// letter and a digit; names of the same characters. The manual gives no length of names; here it
/// is 32. The product's initial password would be refused.
[[nodiscard]] BUSBAR_API PasswordRules rd81opc96_password_rules();

/// Returns Bad_InvalidArgument with the reason; `found` never contains the password or a part of
/// it.
[[nodiscard]] BUSBAR_API Checked<void> check_user_name(const PasswordRules& rules,
                                                       std::string_view name);
/// Checks likewise; a password that equals the name is refused, too.
[[nodiscard]] BUSBAR_API Checked<void>
check_password(const PasswordRules& rules, std::string_view name, std::string_view password);

} // namespace busbar::server
