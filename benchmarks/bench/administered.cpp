#include "administered.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/types/ids.hpp>

#include "own_server.hpp"

namespace busbar::bench {

namespace {

using administration::Setting;
using administration::SettingValues;

/// Takes all, and does nothing with it.
class PlainOwner final : public administration::SettingOwner {
public:
    [[nodiscard]] Variant value(const Setting& setting) const override
    {
        const auto found = values_.find(setting.name);
        return found != values_.end() ? found->second : setting.otherwise;
    }
    [[nodiscard]] bool waits_for_restart(const Setting&) const override { return false; }
    [[nodiscard]] Configured<void> check(const SettingValues&) override { return {}; }
    void apply(const SettingValues& changes) override { values_ = changes; }

private:
    SettingValues values_;
};

/// Makes files of a kilobyte, and takes any.
class PlainTransfers final : public administration::TransferOwner {
public:
    [[nodiscard]] Result<std::vector<std::byte>> generate(const administration::TransferRequest&,
                                                          std::size_t) override
    {
        return std::vector<std::byte>(1'000);
    }
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest&) override
    {
        return status::Good;
    }
    [[nodiscard]] StatusCode take(const administration::TransferRequest&,
                                  std::span<const std::byte>) override
    {
        return status::Good;
    }
};

NodeId role(std::uint32_t number)
{
    return NodeId{0, number};
}

} // namespace

struct Administered::Parts {
    explicit Parts(const Needs& n)
        : needs{n}, files{n.folder}, applications{files, {}, n.log}, user_list{files,
                                                                               "users.json",
                                                                               {},
                                                                               n.users}
    {
    }

    Needs needs;
    storage::FolderStorage files;
    StorageFolder recipe_files{files, "recipes"};
    crypto::CertificateStore applications;
    administration::RoleList roles{files, "roles.json"};
    administration::UserList user_list;
    administration::SettingList settings{
        files,
        "settings.json",
        {{.name = "limits.sessions", .otherwise = Variant{std::int64_t{100}}}}};
    PlainOwner owner;
    PlainTransfers transfers;
    administration::ManagedCertificates certificates{.files = &files,
                                                     .applications = &applications};
    std::optional<administration::Administration> administration;
};

Administered::Administered(const Needs& needs) : parts_{std::make_unique<Parts>(needs)} {}
Administered::~Administered() = default;

const server::RoleMapper& Administered::roles() const
{
    return parts_->roles;
}

bool Administered::prepare(const channel::ApplicationIdentity& identity,
                           const std::string& application_uri)
{
    Parts& parts = *parts_;
    const crypto::OwnCertificateStore own{parts.files};
    if (!parts.applications.create() || !parts.roles.load() || !parts.user_list.load() ||
        !parts.settings.load() ||
        !own.install({identity.certificates, identity.key}, application_uri) ||
        !parts.recipe_files.make_folder("", FileAccess::Owner) ||
        !parts.recipe_files.replace("press.csv", std::vector<std::byte>(1'000),
                                    FileAccess::Owner)) {
        return false;
    }
    for (const std::string_view name : administration_roles) {
        administration::User user;
        user.name = name;
        user.roles = {user.name};
        if (!parts.user_list.add(std::move(user), good_password, parts.needs.random)) {
            return false;
        }
    }
    return true;
}

bool Administered::attach(server::Server& server)
{
    Parts& parts = *parts_;
    const std::vector<NodeId> readers{role(id::WellKnownRole_Operator),
                                      role(id::WellKnownRole_Engineer),
                                      role(id::WellKnownRole_Supervisor)};
    const std::vector<NodeId> writers{role(id::WellKnownRole_ConfigureAdmin)};
    parts.administration.emplace(
        administration::AdministrationParts{.wall_clock = &parts.needs.clock,
                                            .log = &parts.needs.log,
                                            .roles = &parts.roles,
                                            .users = &parts.user_list,
                                            .certificates = &parts.certificates,
                                            .random = &parts.needs.random,
                                            .worker = &parts.needs.worker,
                                            .stop = [] {},
                                            .settings = &parts.settings,
                                            .setting_owner = &parts.owner,
                                            .file_systems = {{.name = "recipes",
                                                              .storage = &parts.recipe_files,
                                                              .readers = readers,
                                                              .writers = writers}},
                                            .file_transfers = {{.name = "backup",
                                                                .owner = &parts.transfers,
                                                                .readers = readers,
                                                                .writers = writers}}});
    return parts.administration->attach(server).has_value();
}

} // namespace busbar::bench
