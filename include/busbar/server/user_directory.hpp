#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/server/password_users.hpp>

namespace busbar::server {

/// Users of all kinds: with passwords, with certificates and with issued tokens. Used on the
/// server's thread, except for passwords().
class BUSBAR_API UserDirectory final : public UserStore {
public:
    /// Bits of AccessLevel by the names of roles in tokens.
    using RoleAccess = std::map<std::string, std::uint8_t, std::less<>>;

    explicit UserDirectory(PasswordRules rules = {}) : passwords_{std::move(rules)} {}

    /// Users with names and passwords, and the rights of anonymous users.
    [[nodiscard]] PasswordUsers& passwords() { return passwords_; }

    /// Accepts user certificates that `validator` trusts. It must outlive this object and should
    /// have a trust list of its own: a trusted application is not a user.
    void accept_certificates(crypto::CertificateValidator& validator) { validator_ = &validator; }
    /// Sets the rights of the user with the certificate of this thumbprint (upper-case
    /// hexadecimal).
    void set_certificate_rights(std::string thumbprint, UserRights rights);
    /// Sets the rights of any other user with a trusted certificate; if nothing, these are refused.
    void set_other_certificate_rights(std::optional<UserRights> rights);

    /// Accepts issued tokens that these rules verify. The user has those of the token's roles that
    /// set_role_access() names (others apply by rules, see UserIdentity), and the access of all of
    /// them together; read access if none of them is known.
    void accept_tokens(crypto::JwtRules rules) { token_rules_ = std::move(rules); }
    /// Sets the access of a role, by its name in tokens.
    void set_role_access(std::string role, std::uint8_t access_level_mask);
    /// Sets the access of these roles, and forgets all others.
    void set_role_access(RoleAccess access) noexcept { role_access_ = std::move(access); }

    [[nodiscard]] Result<UserIdentity> log_in(std::string_view name,
                                              std::string_view password) override;
    [[nodiscard]] Worker* worker() override { return passwords_.worker(); }
    [[nodiscard]] bool has_code(std::string_view name) const override
    {
        return passwords_.has_code(name);
    }
    [[nodiscard]] UserIdentity anonymous() const override { return passwords_.anonymous(); }
    [[nodiscard]] crypto::CertificateValidator* certificate_validator() override
    {
        return validator_;
    }
    [[nodiscard]] Result<UserRights> certificate_user(const crypto::Certificate& user) override;
    [[nodiscard]] const crypto::JwtRules* token_rules() const override
    {
        return token_rules_ ? &*token_rules_ : nullptr;
    }
    [[nodiscard]] Result<UserRights> token_user(const crypto::JwtClaims& claims) override;

private:
    PasswordUsers passwords_;
    crypto::CertificateValidator* validator_{nullptr};
    std::map<std::string, UserRights, std::less<>> certificate_rights_;
    std::optional<UserRights> other_certificate_rights_{UserRights{}};
    std::optional<crypto::JwtRules> token_rules_;
    RoleAccess role_access_;
};

} // namespace busbar::server
