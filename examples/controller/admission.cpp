#include "admission.hpp"

namespace busbar::example {

namespace {

// Part 3, 8.57.
constexpr std::uint8_t read_only = 0x01; // CurrentRead
constexpr std::uint8_t everything = 0xFF;

std::uint8_t mask_of(Access access)
{
    return access == Access::Write ? everything : read_only;
}

bool needs_certificates(const ControllerConfig& config)
{
    return config.server.identity.has_value() && !config.certificates.trusts_all_clients;
}

void make_folders(crypto::CertificateStore& store)
{
    if (const auto made = store.create(); !made) {
        throw ConfigError{store.folder() + ": " + std::string{name(made.error())}};
    }
}

} // namespace

Admission::Admission(const ControllerConfig& config, LogSink& log)
    : trusts_all_clients_{config.certificates.trusts_all_clients},
      client_store_{config.certificates.folder, config.certificates.limits, log},
      client_validator_{client_store_, log, config.certificates.validation},
      user_store_{config.certificates.folder + "/users", config.certificates.limits, log},
      user_validator_{user_store_, log, config.certificates.validation}
{
    if (needs_certificates(config)) {
        make_folders(client_store_);
    }
    if (config.users.certified) {
        make_folders(user_store_);
    }
    add_users(config.users);
}

crypto::CertificateValidator& Admission::clients()
{
    if (trusts_all_clients_) {
        return accept_all_;
    }
    return client_validator_;
}

void Admission::add_users(const UserConfig& config)
{
    server::PasswordUsers& passwords = users_.passwords();
    passwords.set_anonymous_access(mask_of(config.anonymous.value_or(Access::Read)));
    for (const Account& account : config.accounts) {
        if (!passwords.set(account.name, account.password_hash, mask_of(account.access))) {
            throw ConfigError{"account \"" + account.name + "\": the name must not be empty"};
        }
    }
    if (config.certified) {
        users_.accept_certificates(user_validator_);
        users_.set_other_certificate_rights(server::UserRights{mask_of(*config.certified)});
    }
    if (config.tokens) {
        users_.accept_tokens(config.tokens->rules);
        for (const auto& [role, access] : config.tokens->roles) {
            users_.set_role_access(role, mask_of(access));
        }
    }
}

} // namespace busbar::example
