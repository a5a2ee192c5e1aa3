#include <busbar/administration/user_list.hpp>

#include <algorithm>
#include <set>
#include <utility>

#include <busbar/administration/configured_users.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/password_hash.hpp>

#include "json_file.hpp"
#include "role_rules.hpp"

namespace busbar::administration {

namespace {

using detail::Json;

constexpr std::uint32_t version = 1;
constexpr std::uint32_t all_bits = user_bit::no_delete | user_bit::disabled |
                                   user_bit::no_change_by_user | user_bit::must_change_password;
constexpr std::size_t max_description_size = 256;

Unexpected<Refusal> refuse_user(StatusCode status, std::string_view name, std::string found,
                                std::string remedy = {})
{
    return refuse({status, "user list", "user \"" + printable(name) + "\" " + std::move(found),
                   "Part 18, 5.2", std::move(remedy)});
}

bool has(const User& user, std::uint32_t bit)
{
    return (user.configuration & bit) != 0;
}

Checked<void> check_configuration(std::string_view name, std::uint32_t bits)
{
    if ((bits & ~all_bits) != 0) {
        return refuse_user(status::Bad_NotSupported, name,
                           "would have unknown bits in its configuration: " + std::to_string(bits));
    }
    constexpr std::uint32_t both = user_bit::no_change_by_user | user_bit::must_change_password;
    if ((bits & both) == both) {
        return refuse_user(status::Bad_ConfigurationError, name,
                           "would have to change a password that cannot be changed");
    }
    return {};
}

Checked<void> check_description(std::string_view name, std::string_view description)
{
    if (description.size() > max_description_size || !detail::is_kept_whole(description)) {
        return refuse_user(status::Bad_InvalidArgument, name,
                           "has a description that is too long or is not text");
    }
    return {};
}

std::vector<User>::iterator place_of(std::vector<User>& users, std::string_view name)
{
    return std::lower_bound(users.begin(), users.end(), name,
                            [](const User& user, std::string_view n) { return user.name < n; });
}

User* find_in(std::vector<User>& users, std::string_view name)
{
    const auto found = place_of(users, name);
    return found != users.end() && found->name == name ? &*found : nullptr;
}

Unexpected<Refusal> refuse_configured(std::string_view name)
{
    return refuse_user(status::Bad_NotSupported, name, "is not managed online",
                       "Change the user in the configuration that defines it");
}

/// Refuses a new password for which the old one was compared before another change.
Unexpected<Refusal> was_changed(std::string_view name)
{
    return refuse_user(status::Bad_IdentityTokenInvalid, name, "was changed in the meantime");
}

/// Converts a configured user to a user of the list.
User user_of(const ConfiguredUser& user)
{
    return {.name = user.name,
            .configuration = user_bit::no_delete | user_bit::no_change_by_user,
            .description = user.description,
            .roles = user.roles};
}

std::string document_of(const std::vector<User>& users)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("version");
    json.word(std::to_string(version));
    json.name("users");
    json.begin_list();
    for (const User& user : users) {
        json.begin_object();
        json.name("name");
        json.string(user.name);
        json.name("password_hash");
        json.string(user.password_hash);
        json.name("configuration");
        json.word(std::to_string(user.configuration));
        json.name("description");
        json.string(user.description);
        json.name("roles");
        json.begin_list();
        for (const std::string& role : user.roles) {
            json.string(role);
        }
        json.end_list();
        json.end_object();
    }
    json.end_list();
    json.end_object();
    return json.take() + "\n";
}

/// An error in a user of the file.
struct Wrong {
    std::string_view member;
    std::string_view expected;
};

/// Reads a user of the file.
Expected<User, Wrong> user_of(const Json& json)
{
    const std::string* const name = detail::text_of(json, "name");
    const std::string* const hash = detail::text_of(json, "password_hash");
    const auto configuration = detail::number_of(json, "configuration");
    const std::string* const description = detail::text_of(json, "description");
    const Json* const roles = detail::list_of(json, "roles");
    if (name == nullptr || name->empty()) {
        return Unexpected{Wrong{"name", "a name"}};
    }
    if (hash == nullptr || !crypto::is_password_hash(*hash)) {
        return Unexpected{Wrong{"password_hash", "the hash of a password"}};
    }
    if (!configuration || !check_configuration(*name, *configuration)) {
        return Unexpected{Wrong{"configuration", "bits of UserConfigurationMask"}};
    }
    if (description == nullptr) {
        return Unexpected{Wrong{"description", "a text"}};
    }
    const auto is_text = [](const Json& role) { return role.kind == Json::Kind::String; };
    if (roles == nullptr || !std::all_of(roles->items.begin(), roles->items.end(), is_text)) {
        return Unexpected{Wrong{"roles", "a list of texts"}};
    }
    User user{*name, *hash, *configuration, *description, {}};
    for (const Json& role : roles->items) {
        user.roles.push_back(role.text);
    }
    return user;
}

} // namespace

UserList::UserList(Storage& storage, std::string file, server::PasswordRules rules,
                   server::PasswordUsers& users, IsAdministrator is_administrator,
                   const ConfiguredUsers* configured)
    : storage_{&storage}, file_{std::move(file)}, rules_{std::move(rules)}, passwords_{&users},
      is_administrator_{std::move(is_administrator)}, configured_{configured}
{
}

Configured<void> UserList::load()
{
    const auto json = detail::read_json_file(*storage_, file_, version);
    if (!json) {
        return Unexpected{json.error()};
    }
    std::vector<User> users;
    if (*json) {
        const Json* const list = detail::list_of(**json, "users");
        if (list == nullptr) {
            return Unexpected{
                detail::wrong_member(*storage_, file_, "users", (*json)->find("users"), "a list")};
        }
        for (std::size_t i = 0; i < list->items.size(); ++i) {
            auto user = user_of(list->items[i]);
            if (user && find_in(users, user->name) != nullptr) {
                user = Unexpected{Wrong{"name", "each name once"}};
            }
            if (!user) {
                const auto [member, expected] = user.error();
                // Never log a hash.
                const Json* const found =
                    member == "password_hash" ? nullptr : list->items[i].find(member);
                return Unexpected{detail::wrong_member(
                    *storage_, file_, "users[" + std::to_string(i) + "]." + std::string{member},
                    found, expected)};
            }
            const auto place = place_of(users, user->name);
            users.insert(place, *std::move(user));
        }
    }
    const std::lock_guard lock{change_mutex_};
    auto change = publication(users);
    publish(std::move(users), std::move(change));
    return {};
}

std::vector<User> UserList::users() const
{
    const std::lock_guard lock{mutex_};
    return users_;
}

std::vector<User> UserList::all_users() const
{
    std::vector<User> all = users();
    for (const ConfiguredUser& each : configured()) {
        std::erase_if(all, [&](const User& user) { return user.name == each.name; });
        const auto place = place_of(all, each.name);
        all.insert(place, user_of(each));
    }
    return all;
}

std::vector<ConfiguredUser> UserList::configured() const
{
    return configured_ != nullptr ? configured_->users() : std::vector<ConfiguredUser>{};
}

bool UserList::is_configured(std::string_view name) const
{
    return configured_ != nullptr && configured_->has(name);
}

std::optional<User> UserList::find(std::string_view name) const
{
    const std::lock_guard lock{mutex_};
    const auto found = std::find_if(users_.begin(), users_.end(),
                                    [&](const User& user) { return user.name == name; });
    return found == users_.end() ? std::nullopt : std::optional{*found};
}

bool UserList::has_administrator() const
{
    const std::lock_guard lock{mutex_};
    return has_administrator_in(users_);
}

bool UserList::is_administrator(const User& user) const
{
    return is_administrator_ ? is_administrator_(user)
                             : std::find(user.roles.begin(), user.roles.end(), "SecurityAdmin") !=
                                   user.roles.end();
}

bool UserList::has_administrator_in(const std::vector<User>& users) const
{
    const std::vector<ConfiguredUser> others = configured();
    return std::any_of(users.begin(), users.end(),
                       [&](const User& user) {
                           return !has(user, user_bit::disabled) && is_administrator(user);
                       }) ||
           std::any_of(others.begin(), others.end(), [&](const ConfiguredUser& user) {
               return !user.is_temporary && is_administrator(user_of(user));
           });
}

Checked<std::string> UserList::hash(std::string_view name, std::string_view password,
                                    crypto::Random& random) const
{
    if (auto checked = server::check_password(rules_, name, password); !checked) {
        Refusal refusal = std::move(checked).error();
        refusal.status = status::Bad_OutOfRange;
        return refuse(std::move(refusal));
    }
    auto hashed = crypto::hash_password(password, random, rules_.cost);
    if (!hashed) {
        return refuse_user(status::Bad_ResourceUnavailable, name, "has no hash of the password");
    }
    return *std::move(hashed);
}

server::PasswordUsers::Change UserList::publication(const std::vector<User>& users) const
{
    server::PasswordUsers::Change change;
    for (const User& user : users_) {
        const bool stays = std::any_of(users.begin(), users.end(),
                                       [&](const User& each) { return each.name == user.name; });
        if (!stays && !is_configured(user.name)) {
            change.remove(user.name);
        }
    }
    for (const User& user : users) {
        if (is_configured(user.name)) {
            continue;
        }
        if (has(user, user_bit::disabled)) {
            change.remove(user.name);
            continue;
        }
        // This fails only for an invalid hash, and all of these are valid.
        static_cast<void>(change.set(user.name, user.password_hash,
                                     {detail::access_of(user.roles), user.roles,
                                      has(user, user_bit::must_change_password)}));
    }
    return change;
}

Checked<void> UserList::replace(std::vector<User> users)
{
    auto change = publication(users);
    const std::string document = document_of(users);
    const auto written = storage_->replace(
        file_, std::as_bytes(std::span{document.data(), document.size()}), FileAccess::Owner);
    if (!written) {
        return refuse(
            {status_of(written.error()),
             "user list",
             storage_->place(file_) + " cannot be written: " + std::string{text(written.error())},
             {},
             "Nothing was changed"});
    }
    publish(std::move(users), std::move(change));
    return {};
}

void UserList::publish(std::vector<User> users, server::PasswordUsers::Change change)
{
    const std::lock_guard lock{mutex_};
    passwords_->apply(std::move(change));
    users_ = std::move(users);
}

Checked<void> UserList::insert(User user)
{
    const std::lock_guard lock{change_mutex_};
    if (find_in(users_, user.name) != nullptr || is_configured(user.name) ||
        !passwords_->password_hash(user.name).empty()) {
        return refuse_user(status::Bad_AlreadyExists, user.name, "already exists");
    }
    if (users_.size() >= rules_.max_users) {
        return refuse_user(status::Bad_ResourceUnavailable, user.name,
                           "would exceed the limit of " + std::to_string(rules_.max_users),
                           "Remove users who are no longer needed");
    }
    std::vector<User> users = users_;
    const auto place = place_of(users, user.name);
    users.insert(place, std::move(user));
    return replace(std::move(users));
}

Checked<void> UserList::change(std::string_view name,
                               const std::function<Checked<void>(User&)>& apply)
{
    const std::lock_guard lock{change_mutex_};
    std::vector<User> users = users_;
    User* const user = find_in(users, name);
    if (user == nullptr) {
        return refuse_user(status::Bad_NotFound, name, "does not exist");
    }
    if (auto applied = apply(*user); !applied) {
        return applied;
    }
    if (has_administrator_in(users_) && !has_administrator_in(users)) {
        return refuse_user(status::Bad_RequestNotAllowed, name, "is the last administrator",
                           "Add another one first");
    }
    return replace(std::move(users));
}

Checked<UserList::Prepared> UserList::prepare_add(User user, std::string_view password,
                                                  crypto::Random& random)
{
    if (auto checked = server::check_user_name(rules_, user.name); !checked) {
        return refuse(std::move(checked).error());
    }
    if (auto checked = check_configuration(user.name, user.configuration); !checked) {
        return refuse(std::move(checked).error());
    }
    if (auto checked = check_description(user.name, user.description); !checked) {
        return refuse(std::move(checked).error());
    }
    auto hashed = hash(user.name, password, random);
    if (!hashed) {
        return refuse(std::move(hashed).error());
    }
    user.password_hash = *std::move(hashed);
    return Prepared{[this, added = std::move(user)]() mutable { return insert(std::move(added)); }};
}

Checked<void> UserList::add(User user, std::string_view password, crypto::Random& random)
{
    const auto prepared = prepare_add(std::move(user), password, random);
    return prepared ? (*prepared)() : refuse(prepared.error());
}

Checked<UserList::Prepared>
UserList::prepare_modify(std::string_view name, const UserChange& change, crypto::Random& random)
{
    if (is_configured(name)) {
        return refuse_configured(name);
    }
    if (change.configuration) {
        if (auto checked = check_configuration(name, *change.configuration); !checked) {
            return refuse(std::move(checked).error());
        }
    }
    if (change.description) {
        if (auto checked = check_description(name, *change.description); !checked) {
            return refuse(std::move(checked).error());
        }
    }
    std::optional<std::string> hashed;
    if (change.password) {
        auto made = hash(name, *change.password, random);
        if (!made) {
            return refuse(std::move(made).error());
        }
        hashed = *std::move(made);
    }
    auto description =
        change.description ? std::optional{std::string{*change.description}} : std::nullopt;
    return Prepared{[this, whose = std::string{name}, hashed = std::move(hashed),
                     bits = change.configuration, description = std::move(description),
                     roles = change.roles]() mutable {
        return this->change(whose, [&](User& user) {
            user.password_hash = std::move(hashed).value_or(user.password_hash);
            user.configuration = bits.value_or(user.configuration);
            user.description = std::move(description).value_or(user.description);
            user.roles = std::move(roles).value_or(user.roles);
            return Checked<void>{};
        });
    }};
}

Checked<void> UserList::modify(std::string_view name, const UserChange& change,
                               crypto::Random& random)
{
    const auto prepared = prepare_modify(name, change, random);
    return prepared ? (*prepared)() : refuse(prepared.error());
}

Checked<void> UserList::remove(std::string_view name)
{
    if (is_configured(name)) {
        return refuse_configured(name);
    }
    const std::lock_guard lock{change_mutex_};
    std::vector<User> users = users_;
    const User* const user = find_in(users, name);
    if (user == nullptr) {
        return refuse_user(status::Bad_NotFound, name, "does not exist");
    }
    if (has(*user, user_bit::no_delete)) {
        return refuse_user(status::Bad_NotSupported, name, "cannot be removed",
                           "Take NoDelete from the user's configuration first");
    }
    users.erase(place_of(users, name));
    if (has_administrator_in(users_) && !has_administrator_in(users)) {
        return refuse_user(status::Bad_RequestNotAllowed, name, "is the last administrator",
                           "Add another one first");
    }
    return replace(std::move(users));
}

Checked<UserList::Prepared> UserList::prepare_change_password(std::string_view name,
                                                              std::string_view old_password,
                                                              std::string_view new_password,
                                                              crypto::Random& random)
{
    const bool is_of_program = is_configured(name);
    std::optional<User> known = is_of_program ? std::optional{User{}} : find(name);
    if (is_of_program) {
        known->password_hash = passwords_->password_hash(name);
    }
    const auto is_right = [&](const User& user) {
        return crypto::verify_password(old_password, user.password_hash);
    };
    if (!known || has(*known, user_bit::disabled) || !is_right(*known)) {
        return refuse_user(status::Bad_IdentityTokenInvalid, name,
                           "does not exist or has another password");
    }
    if (is_of_program) {
        return refuse_configured(name);
    }
    if (has(*known, user_bit::no_change_by_user)) {
        return refuse_user(status::Bad_NotSupported, name, "cannot change the password",
                           "An administrator can");
    }
    if (old_password == new_password) {
        return refuse_user(status::Bad_AlreadyExists, name, "has that password already");
    }
    auto hashed = hash(name, new_password, random);
    if (!hashed) {
        return refuse(std::move(hashed).error());
    }
    return Prepared{[this, whose = std::string{name}, before = std::move(known->password_hash),
                     hashed = *std::move(hashed)]() mutable {
        const auto changed = change(whose, [&](User& user) {
            // Another change may have been made first.
            if (user.password_hash != before) {
                return Checked<void>{was_changed(whose)};
            }
            user.password_hash = std::move(hashed);
            user.configuration &= ~user_bit::must_change_password;
            return Checked<void>{};
        });
        return !changed && changed.error().status == status::Bad_NotFound
                   ? Checked<void>{was_changed(whose)}
                   : changed;
    }};
}

Checked<void> UserList::change_password(std::string_view name, std::string_view old_password,
                                        std::string_view new_password, crypto::Random& random)
{
    const auto prepared = prepare_change_password(name, old_password, new_password, random);
    return prepared ? (*prepared)() : refuse(prepared.error());
}

} // namespace busbar::administration
