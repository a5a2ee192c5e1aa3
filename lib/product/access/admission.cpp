#include "admission.hpp"

#include <utility>

namespace busbar::product {

namespace {

// Part 3, 8.57.
constexpr std::uint8_t read_only = 0x01; // CurrentRead
constexpr std::uint8_t everything = 0xFF;

/// Returns the access level mask; an administrator can read and write the variables of
/// administration.
std::uint8_t mask_of(AccountAccess access)
{
    return access == AccountAccess::Read ? read_only : everything;
}

bool needs_certificates(const ControllerConfig& config)
{
    return config.server.identity.has_value() && !config.certificates.trusts_all_clients;
}

/// Returns the first kind of user that only one of both admits; empty if there is none.
std::string changed_kind(const UserConfig& before, const UserConfig& after)
{
    const std::pair<const char*, bool> kinds[] = {
        {"accounts", before.accounts.empty() != after.accounts.empty()},
        {"users with certificates", before.certified.has_value() != after.certified.has_value()},
        {"users with tokens", before.tokens.has_value() != after.tokens.has_value()}};
    for (const auto& [name, has_changed] : kinds) {
        if (has_changed) {
            return name;
        }
    }
    return {};
}

void make_folders(crypto::CertificateStore& store)
{
    if (const auto made = store.create(); !made) {
        throw ConfigError{
            Problem{made.error(), store.storage().place(""), "the folder cannot be made"}};
    }
}

} // namespace

Admission::Admission(const ControllerConfig& config, Storage& files, LogSink& log)
    : trusts_all_clients_{config.certificates.trusts_all_clients},
      has_client_folders_{needs_certificates(config)}, client_store_{files,
                                                                     config.certificates.limits,
                                                                     log},
      client_validator_{client_store_, log, config.certificates.validation},
      user_files_{files, "users"}, user_store_{user_files_, config.certificates.limits, log},
      user_validator_{user_store_, log, config.certificates.validation}
{
    if (has_client_folders_) {
        make_folders(client_store_);
    }
    if (config.users.certified) {
        make_folders(user_store_);
    }
    admit(prepare(config.users));
}

crypto::CertificateValidator& Admission::clients()
{
    if (trusts_all_clients_) {
        return accept_all_;
    }
    return client_validator_;
}

Admission::Users Admission::prepare(UserConfig users) const
{
    Users all;
    for (const Account& account : config_.accounts) {
        all.accounts.remove(account.name);
    }
    for (const Account& account : users.accounts) {
        if (!all.accounts.set(account.name, account.password_hash,
                              {.access_level_mask = mask_of(account.access),
                               .roles = account.roles,
                               .administers_only = account.access == AccountAccess::None})) {
            throw ConfigError{"account \"" + account.name + "\"", "the name is empty"};
        }
    }
    if (users.tokens) {
        all.rules = users.tokens->rules;
        for (const auto& [role, access] : users.tokens->roles) {
            all.roles.insert_or_assign(role, mask_of(access));
        }
    }
    all.config = std::move(users);
    return all;
}

Admission::Users Admission::prepare(UserConfig users, const std::string& file) const
{
    if (const std::string kind = changed_kind(config_, users); !kind.empty()) {
        throw ConfigError{file + ": [users]",
                          kind + " were added or removed, expected the kinds of user that the "
                                 "controller started with: restart the controller"};
    }
    return prepare(std::move(users));
}

void Admission::admit(Users users) noexcept
{
    config_ = std::move(users.config);
    let_anonymous_in(config_.anonymous);
    users_.passwords().apply(std::move(users.accounts));
    if (config_.certified) {
        users_.accept_certificates(user_validator_);
        users_.set_other_certificate_rights(server::UserRights{mask_of(*config_.certified)});
    }
    users_.set_role_access(std::move(users.roles));
    if (users.rules) {
        users_.accept_tokens(*std::move(users.rules));
    }
}

void Admission::let_anonymous_in(std::optional<AccountAccess> access)
{
    config_.anonymous = access;
    users_.passwords().set_anonymous_access(mask_of(access.value_or(AccountAccess::Read)));
}

void Admission::tell_found_certificates(DateTime now)
{
    if (has_client_folders_) {
        client_store_.tell_found_changes(now);
    }
    if (config_.certified) {
        user_store_.tell_found_changes(now);
    }
}

std::string Admission::read_certificates(DateTime now)
{
    tell_found_certificates(now);
    const auto count = [now](crypto::CertificateStore& store) {
        const crypto::TrustList& list = store.trust_list(now);
        return std::to_string(list.trusted.size()) + " trusted certificates and " +
               std::to_string(list.issuers.size()) + " issuers";
    };
    std::string text = trusts_all_clients_   ? "every client is trusted"
                       : has_client_folders_ ? count(client_store_)
                                             : "no client needs a certificate";
    return config_.certified ? text + ", of users " + count(user_store_) : text;
}

} // namespace busbar::product
