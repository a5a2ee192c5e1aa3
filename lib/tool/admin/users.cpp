#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/connection/credentials.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace {

/// The server's rules for names and passwords, as far as it tells them (Part 18, 5.2.2).
std::string rules_of(Connection& connection)
{
    const Variant length = read(connection, standard(id::UserManagement_PasswordLength));
    const Variant text = read(connection, standard(id::UserManagement_PasswordRestrictions));
    std::string rules;
    if (const auto* const object = length.get_if<ExtensionObject>()) {
        if (const auto* const range = object->get_if<Range>()) {
            rules = "a password has " + std::to_string(static_cast<int>(range->low)) + " to " +
                    std::to_string(static_cast<int>(range->high)) + " characters";
        }
    }
    const auto* const told = text.get_if<LocalizedText>();
    return rules + (told != nullptr ? "; " + safe(told->text.view()) : std::string{});
}

/// Calls a function that may break the server's rules, and adds the rules to the Failure.
template <typename Function>
void by_rules(Connection& connection, Function&& function)
{
    try {
        function();
    } catch (Failure& failure) {
        if (!failure.reason.empty()) {
            throw;
        }
        if (failure.status == status::Bad_InvalidArgument ||
            failure.status == status::Bad_OutOfRange) {
            failure.hint = rules_of(connection);
        } else if (failure.status == status::Bad_ResourceUnavailable) {
            failure.hint = "the server has the maximum number of users, or cannot store them";
        }
        throw;
    }
}

} // namespace

void add_user(Connection& connection, const std::string& name, const crypto::Secret& password,
              std::uint32_t bits, const std::string& description)
{
    by_rules(connection, [&] {
        call(connection, standard(id::UserManagement), standard(id::UserManagement_AddUser),
             {Variant{String{name}}, Variant{String{password.text()}}, Variant{bits},
              Variant{String{description}}},
             "adding " + safe(name));
    });
}

void change_user(Connection& connection, const std::string& name, const crypto::Secret* password,
                 std::optional<std::uint32_t> bits)
{
    by_rules(connection, [&] {
        call(connection, standard(id::UserManagement), standard(id::UserManagement_ModifyUser),
             {Variant{String{name}}, Variant{password != nullptr},
              Variant{String{password != nullptr ? password->text() : std::string_view{}}},
              Variant{bits.has_value()}, Variant{bits.value_or(0)}, Variant{false},
              Variant{String{}}},
             "changing " + safe(name));
    });
}

namespace users {
namespace {

constexpr auto disabled = static_cast<std::uint32_t>(UserConfigurationMask::Disabled);
constexpr auto must_change = static_cast<std::uint32_t>(UserConfigurationMask::MustChangePassword);

std::vector<UserManagementDataType> users_of(Connection& connection)
{
    if (auto users = find_users(connection)) {
        return *std::move(users);
    }
    throw Failure{status::Bad_UserAccessDenied, "reading the users",
                  "log in as one with the role SecurityAdmin, over an encrypted channel"};
}

std::string flags_of(UserConfigurationMask mask)
{
    struct Flag {
        UserConfigurationMask bit;
        const char* name;
    };
    std::string text;
    for (const Flag& flag :
         {Flag{UserConfigurationMask::NoDelete, "cannot be removed"},
          Flag{UserConfigurationMask::Disabled, "disabled"},
          Flag{UserConfigurationMask::NoChangeByUser, "password is fixed"},
          Flag{UserConfigurationMask::MustChangePassword, "must change the password"}}) {
        if ((static_cast<std::uint32_t>(mask) & static_cast<std::uint32_t>(flag.bit)) != 0) {
            text += (text.empty() ? "" : ", ") + std::string{flag.name};
        }
    }
    return text;
}

Exit list(Context& context, Connection& connection, const AdminArguments&)
{
    JsonLine json;
    json.open_array();
    Table table{{{"NAME", 12}, {"CONFIGURATION"}, {"DESCRIPTION"}}};
    for (const UserManagementDataType& user : users_of(connection)) {
        const std::string flags = flags_of(user.user_configuration);
        json.open_object().member("name", user.user_name.view()).member("configuration", flags);
        json.member("description", user.description.view()).close_object();
        table.add({{safe(user.user_name.view())}, {flags}, {safe(user.description.view())}});
    }
    return print_rows(context, json.close_array(), table, "No users");
}

void on_users(Connection& connection, std::uint32_t method, const std::vector<Variant>& inputs,
              const std::string& what)
{
    try {
        call(connection, standard(id::UserManagement), standard(method), inputs, what);
    } catch (Failure& failure) {
        if (failure.status == status::Bad_NotSupported) {
            failure.hint = "`busbar admin user list` tells which users cannot be changed; those of "
                           "the configuration file are changed in it";
        }
        throw;
    }
}

Exit add(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& name = arguments.words.front();
    const crypto::Secret password = new_password(context, name, arguments.new_password_file);
    add_user(connection, name, password, arguments.must_change ? must_change : std::uint32_t{0},
             arguments.description);
    return report(context,
                  "added " + safe(name) + "; roles are given by `busbar admin role grant`");
}

/// Sets or clears a bit of the user's configuration.
void set_bit(Connection& connection, const std::string& name, std::uint32_t bit, bool is_set)
{
    for (const UserManagementDataType& user : users_of(connection)) {
        if (user.user_name.view() == name) {
            const auto bits = static_cast<std::uint32_t>(user.user_configuration);
            return change_user(connection, name, nullptr, is_set ? bits | bit : bits & ~bit);
        }
    }
    throw Failure{status::Bad_NotFound, safe(name), "see `busbar admin user list`"};
}

Exit disable(Context& context, Connection& connection, const AdminArguments& arguments)
{
    set_bit(connection, arguments.words.front(), disabled, true);
    return report(context, "disabled " + safe(arguments.words.front()));
}

Exit enable(Context& context, Connection& connection, const AdminArguments& arguments)
{
    set_bit(connection, arguments.words.front(), disabled, false);
    return report(context, "enabled " + safe(arguments.words.front()));
}

/// Changes the password of the user who is logged in, who gives the present one (Part 18, 5.2.8).
void change_own(Context& context, Connection& connection, const crypto::Secret& password)
{
    const auto identity = user_of(context);
    const auto* const known = std::get_if<client::NamedUser>(&identity);
    by_rules(connection, [&] {
        call(connection, standard(id::UserManagement), standard(id::UserManagement_ChangePassword),
             {Variant{String{known != nullptr ? known->password : std::string{}}},
              Variant{String{password.text()}}},
             "changing your own password");
    });
}

Exit set_password(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& name = arguments.words.front();
    const crypto::Secret password = new_password(context, name, arguments.new_password_file);
    if (name == context.options.user && context.options.user_certificate.empty()) {
        change_own(context, connection, password);
    } else {
        change_user(connection, name, &password, std::nullopt);
    }
    return report(context, "changed the password of " + safe(name));
}

Exit remove(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& name = arguments.words.front();
    make_sure(context, arguments, "Sessions of the user end. Remove " + safe(name) + "?");
    on_users(connection, id::UserManagement_RemoveUser, {Variant{String{name}}},
             "removing " + safe(name));
    return report(context, "removed " + safe(name));
}

} // namespace
} // namespace users

void add_users(CLI::App& admin, Run& run)
{
    using namespace users;
    Group group{admin, run, "user", "The server's users with passwords."};
    auto& arguments = group.arguments();
    group.add("list", "Lists users.", 0, "URL", list);
    auto* added = group.add("add", "Adds a user.", 1, "NAME", add);
    added->add_option("--description", arguments.description, "what the user is for");
    added->add_flag("--must-change", arguments.must_change,
                    "the password has to be changed at the first login");
    auto* changed = group.add("password", "Gives a user, or yourself, another password.", 1, "NAME",
                              set_password);
    for (auto* command : {added, changed}) {
        command->add_option("--new-password-file", arguments.new_password_file,
                            "its first line is the password; asked for on a terminal otherwise");
    }
    group.add("disable", "Stops a user from logging in.", 1, "NAME", disable);
    group.add("enable", "Lets a user log in again.", 1, "NAME", enable);
    group.add("remove", "Removes a user.", 1, "NAME", remove)
        ->add_flag("--yes", arguments.is_sure, "do not ask");
}

} // namespace busbar::tool::admin
