#include <busbar/server/password_rules.hpp>

#include <algorithm>
#include <string>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "core/utf8.hpp"

namespace busbar::server {

namespace {

constexpr std::string_view name_check = "user name rules";
constexpr std::string_view password_check = "password rules";
constexpr std::string_view rule = "rules for names and passwords";

bool has_one_of(std::string_view text, char first, char last)
{
    return std::any_of(text.begin(), text.end(), [&](char c) { return c >= first && c <= last; });
}

std::size_t count_characters(std::string_view text)
{
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; // not a continuation
    }));
}

/// Makes no copy, since the text may be a password.
bool has_control_character(std::string_view text)
{
    return std::any_of(text.begin(), text.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

std::string words_for(std::string_view characters)
{
    return characters == letters_and_digits              ? "A to Z, a to z and 0 to 9"
           : characters == letters_digits_and_underscore ? "A to Z, a to z, 0 to 9 and _"
                                                         : std::string{characters};
}

/// Returns what is wrong with `text`, to be appended to its subject; empty if nothing is.
std::string find_fault(std::string_view text, std::size_t least, std::size_t most,
                       std::string_view characters)
{
    if (has_control_character(text)) {
        return "has control characters";
    }
    if (!characters.empty() && text.find_first_not_of(characters) != std::string_view::npos) {
        return "has characters other than " + words_for(characters);
    }
    if (count_characters(text) < least || text.size() > most) {
        return "must have " + std::to_string(least) + " to " + std::to_string(most) + " characters";
    }
    return {};
}

Checked<void> judge(std::string_view check, std::string fault)
{
    if (fault.empty()) {
        return {};
    }
    return refuse({status::Bad_InvalidArgument, check, std::move(fault), rule,
                   "Choose another one that fits the rules"});
}

std::string quoted(std::string_view name)
{
    return "\"" + printable(name) + "\"";
}

std::string find_name_fault(const PasswordRules& rules, std::string_view name)
{
    const bool is_reserved = std::any_of(
        rules.reserved_names.begin(), rules.reserved_names.end(), [&](std::string_view reserved) {
            return busbar::detail::is_same_ignoring_case(reserved, name);
        });
    if (is_reserved) {
        return quoted(name) + " is a reserved name";
    }
    if (!name.empty() && !busbar::detail::is_name(name)) {
        return quoted(name) +
               " is not UTF-8, has control characters, or begins or ends with a space";
    }
    const std::string fault =
        find_fault(name, rules.min_name_length, rules.max_name_length, rules.name_characters);
    return fault.empty() ? fault : quoted(name) + " " + fault;
}

std::string find_password_fault(const PasswordRules& rules, std::string_view name,
                                std::string_view password)
{
    if (busbar::detail::is_same_ignoring_case(name, password)) {
        return "it is the user's name";
    }
    if (rules.needs_letters_and_digit &&
        !(has_one_of(password, 'A', 'Z') && has_one_of(password, 'a', 'z') &&
          has_one_of(password, '0', '9'))) {
        return "it lacks an upper-case letter, a lower-case letter or a digit";
    }
    const std::string fault = find_fault(password, rules.min_password_length,
                                         rules.max_password_length, rules.password_characters);
    return fault.empty() ? fault : "it " + fault;
}

} // namespace

PasswordRules nj501_password_rules()
{
    PasswordRules rules;
    rules.min_name_length = 4;
    rules.max_name_length = 32;
    rules.min_password_length = 8;
    rules.max_password_length = 32;
    rules.name_characters = letters_and_digits;
    rules.password_characters = letters_and_digits;
    rules.reserved_names = {"Administrator", "Designer", "Maintainer",
                            "Operator",      "Observer", "Anonymous"};
    rules.max_users = 20;
    return rules;
}

PasswordRules rd81opc96_password_rules()
{
    PasswordRules rules;
    rules.max_name_length = 32;
    rules.min_password_length = 6;
    rules.max_password_length = 32;
    rules.name_characters = letters_digits_and_underscore;
    rules.password_characters = letters_digits_and_underscore;
    rules.needs_letters_and_digit = true;
    return rules;
}

Checked<void> check_user_name(const PasswordRules& rules, std::string_view name)
{
    return judge(name_check, find_name_fault(rules, name));
}

Checked<void> check_password(const PasswordRules& rules, std::string_view name,
                             std::string_view password)
{
    return judge(password_check, find_password_fault(rules, name, password));
}

} // namespace busbar::server
