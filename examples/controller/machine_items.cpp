#include "machine_items.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/administration/role_list.hpp>
#include <busbar/administration/setting_list.hpp>
#include <busbar/administration/user_list.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "machine_files.hpp"

namespace busbar::example {

namespace {

using controller::MemoryGroup;
using controller::MemoryItem;

/// The file as the list that it is for reads it at a start.
template <typename Load>
Configured<void> check_file(std::string_view name, std::span<const std::byte> bytes, Load load)
{
    storage::MemoryStorage memory;
    if (const auto kept = memory.replace(name, bytes, FileAccess::Owner); !kept) {
        return misconfigured(std::string{name}, std::string{text(kept.error())},
                             status_of(kept.error()));
    }
    return load(memory, std::string{name});
}

MemoryItem settings_item(Settings& settings)
{
    MemoryItem item{.name = "Server settings", .files = {Settings::file_name}};
    item.check = [&settings](std::string_view name, std::span<const std::byte> bytes) {
        return check_file(name, bytes, [&](Storage& memory, std::string file) {
            const auto all = settings.list().settings();
            administration::SettingList list{memory, std::move(file), {all.begin(), all.end()}};
            return list.load().and_then([&] { return settings.check(list.changes()); });
        });
    };
    return item;
}

MemoryItem users_item(const Settings& settings)
{
    MemoryItem item{
        .name = "Users", .group = MemoryGroup::SecurityProfile, .files = {"users.json"}};
    item.check = [&settings](std::string_view name, std::span<const std::byte> bytes) {
        return check_file(name, bytes, [&](Storage& memory, std::string file) {
            server::PasswordUsers nobody;
            administration::UserList list{memory, std::move(file),
                                          settings.config().users.password_rules, nobody};
            return list.load();
        });
    };
    return item;
}

MemoryItem roles_item()
{
    MemoryItem item{
        .name = "Roles", .group = MemoryGroup::SecurityProfile, .files = {"roles.json"}};
    item.check = [](std::string_view name, std::span<const std::byte> bytes) {
        return check_file(name, bytes, [](Storage& memory, std::string file) {
            return administration::RoleList{memory, std::move(file)}.load();
        });
    };
    return item;
}

/// Whatever lies in these folders: the stores pass over what is no certificate.
MemoryItem certificates_item(std::string name, std::vector<std::string> folders)
{
    return {.name = std::move(name),
            .group = MemoryGroup::SecurityProfile,
            .folders = std::move(folders),
            .access = FileAccess::Everyone};
}

} // namespace

std::vector<MemoryItem> machine_items(Settings& settings)
{
    return {settings_item(settings),
            certificates_item("Client certificates", {"trusted/certs"}),
            certificates_item("CA certificates", {"issuers/certs"}),
            certificates_item("Certificate revocation lists", {"trusted/crl", "issuers/crl"}),
            certificates_item("User certificates", {"users/trusted/certs", "users/trusted/crl",
                                                    "users/issuers/certs", "users/issuers/crl"}),
            users_item(settings),
            roles_item(),
            {.name = "Event log",
             .group = MemoryGroup::EventLog,
             .folders = {std::string{MachineFiles::event_folder}}},
            {.name = "Server certificate",
             .group = MemoryGroup::ServerCertificate,
             .files = {"setup.code"},
             .folders = {"own/certs", "own/private", "own/crl", "own/replaced", "rejected/certs",
                         "rejected/crl", "users/rejected/certs", "users/rejected/crl"}}};
}

} // namespace busbar::example
