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
#include "product/configuration/setting_keys.hpp"

namespace busbar::product {

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

using administration::SettingValues;
using Bytes = controller::FilePart::Bytes;

/// What a file of settings says; nothing if it has no bytes.
Configured<SettingValues> values_in(const Settings& settings, std::span<const std::byte> bytes)
{
    if (bytes.empty()) {
        return SettingValues{};
    }
    SettingValues values;
    const auto read =
        check_file(Settings::file_name, bytes, [&](Storage& memory, std::string file) {
            const auto all = settings.list().settings();
            administration::SettingList list{memory, std::move(file), {all.begin(), all.end()}};
            auto loaded = list.load();
            values = list.changes();
            return loaded;
        });
    return read.transform([&] { return std::move(values); });
}

Bytes document_of(const SettingValues& values)
{
    if (values.empty()) {
        return {};
    }
    const std::string document = administration::settings_document(values);
    const auto bytes = std::as_bytes(std::span{document});
    return {bytes.begin(), bytes.end()};
}

/// The settings that are of the security profile, or those that are not.
controller::FilePart settings_part(const Settings& settings, bool is_of_profile)
{
    const auto is_other = [is_of_profile](const SettingValues::value_type& each) {
        return is_security_setting(each.first) != is_of_profile;
    };
    controller::FilePart part{.file = Settings::file_name};
    part.take = [&settings, is_other](std::span<const std::byte> whole) -> Configured<Bytes> {
        auto values = values_in(settings, whole);
        if (!values) {
            return Unexpected{std::move(values.error())};
        }
        std::erase_if(*values, is_other);
        return document_of(*values);
    };
    part.put = [&settings, is_other](std::span<const std::byte> whole,
                                     std::span<const std::byte> own) -> Configured<Bytes> {
        auto all = values_in(settings, whole);
        auto values = values_in(settings, own);
        if (!all || !values) {
            return Unexpected{std::move(all ? values.error() : all.error())};
        }
        std::erase_if(*all, [&](const auto& each) { return !is_other(each); });
        std::erase_if(*values, is_other);
        all->merge(*values);
        return document_of(*all);
    };
    return part;
}

MemoryItem settings_item(Settings& settings, std::string name, std::string file, MemoryGroup group)
{
    MemoryItem item{.name = std::move(name), .group = group, .files = {std::move(file)}};
    item.part = settings_part(settings, group == MemoryGroup::SecurityProfile);
    item.check = [&settings](std::string_view, std::span<const std::byte> bytes) {
        return values_in(settings, bytes).and_then([&](const SettingValues& values) {
            return settings.check(values);
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
    return {settings_item(settings, "Server settings", Settings::file_name,
                          MemoryGroup::ServerSettings),
            certificates_item("Client certificates", {"trusted/certs"}),
            certificates_item("CA certificates", {"issuers/certs"}),
            certificates_item("Certificate revocation lists", {"trusted/crl", "issuers/crl"}),
            certificates_item("User certificates", {"users/trusted/certs", "users/trusted/crl",
                                                    "users/issuers/certs", "users/issuers/crl"}),
            settings_item(settings, "Security settings", "security-settings.json",
                          MemoryGroup::SecurityProfile),
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

} // namespace busbar::product
