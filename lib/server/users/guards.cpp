#include "guards.hpp"

namespace busbar::server::detail {

bool GuardedAccess::may_browse(const UserIdentity& user, const NodeId& node) const
{
    return report_.guard("AccessControl::may_browse", false,
                         [&] { return inner_->may_browse(user, node); });
}

std::uint8_t GuardedAccess::user_access_level(const UserIdentity& user, const NodeId& node,
                                              std::uint8_t access_level) const
{
    return report_.guard("AccessControl::user_access_level", std::uint8_t{0},
                         [&] { return inner_->user_access_level(user, node, access_level); });
}

bool GuardedAccess::may_call(const UserIdentity& user, const NodeId& method) const
{
    return report_.guard("AccessControl::may_call", false,
                         [&] { return inner_->may_call(user, method); });
}

std::uint32_t GuardedAccess::user_write_mask(const UserIdentity& user, const NodeId& node,
                                             std::uint32_t write_mask) const
{
    return report_.guard("AccessControl::user_write_mask", std::uint32_t{0},
                         [&] { return inner_->user_write_mask(user, node, write_mask); });
}

bool GuardedAccess::may_add_node(const UserIdentity& user, const NodeId& parent) const
{
    return report_.guard("AccessControl::may_add_node", false,
                         [&] { return inner_->may_add_node(user, parent); });
}

bool GuardedAccess::may_delete_node(const UserIdentity& user, const NodeId& node) const
{
    return report_.guard("AccessControl::may_delete_node", false,
                         [&] { return inner_->may_delete_node(user, node); });
}

bool GuardedAccess::may_add_reference(const UserIdentity& user, const NodeId& node) const
{
    return report_.guard("AccessControl::may_add_reference", false,
                         [&] { return inner_->may_add_reference(user, node); });
}

bool GuardedAccess::may_remove_reference(const UserIdentity& user, const NodeId& node) const
{
    return report_.guard("AccessControl::may_remove_reference", false,
                         [&] { return inner_->may_remove_reference(user, node); });
}

Checked<void> GuardedValidator::validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context)
{
    Checked<void> verdict;
    const StatusCode thrown = report_.guard("CertificateValidator::validate",
                                            [&] { verdict = inner_->validate(chain, context); });
    if (thrown.is_bad()) {
        return refuse({thrown, "certificate", "the validator threw an exception", {}, {}});
    }
    return verdict;
}

Result<UserIdentity> GuardedUsers::log_in(std::string_view name, std::string_view password)
{
    Result<UserIdentity> user{fail(status::Bad_UserAccessDenied)};
    const StatusCode thrown =
        report_.guard("UserStore::log_in", [&] { user = inner_->log_in(name, password); });
    return thrown.is_bad() ? Result<UserIdentity>{fail(thrown)} : user;
}

Worker* GuardedUsers::worker()
{
    return report_.guard("UserStore::worker", static_cast<Worker*>(nullptr),
                         [&] { return inner_->worker(); });
}

bool GuardedUsers::has_code(std::string_view name) const
{
    return report_.guard("UserStore::has_code", false, [&] { return inner_->has_code(name); });
}

UserIdentity GuardedUsers::anonymous() const
{
    return report_.guard("UserStore::anonymous", UserIdentity{UserTokenType::Anonymous, {}, 0},
                         [&] { return inner_->anonymous(); });
}

crypto::CertificateValidator* GuardedUsers::certificate_validator()
{
    auto* const found = report_.guard("UserStore::certificate_validator",
                                      static_cast<crypto::CertificateValidator*>(nullptr),
                                      [&] { return inner_->certificate_validator(); });
    validator_.guard(found);
    return found != nullptr ? &validator_ : nullptr;
}

Result<UserRights> GuardedUsers::certificate_user(const crypto::Certificate& certificate)
{
    Result<UserRights> rights{UserRights{}};
    const StatusCode thrown = report_.guard(
        "UserStore::certificate_user", [&] { rights = inner_->certificate_user(certificate); });
    return thrown.is_bad() ? Result<UserRights>{fail(thrown)} : rights;
}

const crypto::JwtRules* GuardedUsers::token_rules() const
{
    return report_.guard("UserStore::token_rules", static_cast<const crypto::JwtRules*>(nullptr),
                         [&] { return inner_->token_rules(); });
}

Result<UserRights> GuardedUsers::token_user(const crypto::JwtClaims& claims)
{
    Result<UserRights> rights{UserRights{}};
    const StatusCode thrown =
        report_.guard("UserStore::token_user", [&] { rights = inner_->token_user(claims); });
    return thrown.is_bad() ? Result<UserRights>{fail(thrown)} : rights;
}

Guards::Guards(const ServerEnvironment& environment, LogSink& rationed)
    : given_{environment}, report_{&rationed, &request_}, log_{*environment.log},
      validator_{report_}, users_{environment.users, report_}, access_{environment.access, report_}
{
    validator_.guard(environment.validator);
}

ServerEnvironment Guards::environment()
{
    ServerEnvironment guarded = given_;
    guarded.log = &log_;
    guarded.validator = given_.validator != nullptr ? &validator_ : nullptr;
    guarded.users = given_.users != nullptr ? &users_ : nullptr;
    guarded.access = given_.access != nullptr ? &access_ : nullptr;
    return guarded;
}

} // namespace busbar::server::detail
