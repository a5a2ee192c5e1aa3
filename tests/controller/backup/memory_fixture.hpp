#pragma once

#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <busbar/controller/backup.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "controller/life/life_fixture.hpp"

namespace busbar::test {

/// The lines of "options" that begin so.
inline controller::FilePart lines_part(const std::string& word)
{
    using Bytes = controller::FilePart::Bytes;
    const auto lines = [word](std::span<const std::byte> bytes, bool is_mine) {
        std::string kept;
        std::istringstream text{{reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
        for (std::string line; std::getline(text, line);) {
            kept += line.starts_with(word) == is_mine ? line + "\n" : "";
        }
        return kept;
    };
    const auto bytes_of = [](const std::string& text) {
        const auto bytes = std::as_bytes(std::span{text});
        return Bytes{bytes.begin(), bytes.end()};
    };
    return {.file = "options",
            .take = [=](auto whole) -> Configured<Bytes> { return bytes_of(lines(whole, true)); },
            .put = [=](auto whole, auto part) -> Configured<Bytes> {
                return bytes_of(lines(whole, false) + lines(part, true));
            }};
}

/// Server and login are to be of one kind.
inline Configured<void> check_options(std::string_view name, std::span<const std::byte> bytes)
{
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    const bool is_strange = text.find("server strict") != std::string_view::npos &&
                            text.find("login anybody") != std::string_view::npos;
    return is_strange ? misconfigured(std::string{name}, "found anybody, expected a user")
                      : Configured<void>{};
}

/// The data of a controller as busbar-controller lays it out: certificates in trusted/, issuers/
/// and own/, users and settings in files.
inline std::vector<controller::MemoryItem> machine_items()
{
    using controller::MemoryGroup;
    using controller::MemoryItem;
    const auto check = [](std::string_view name, std::span<const std::byte> bytes) {
        const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        return controller::read_server_settings(text, std::string{name}).transform([](const auto&) {
        });
    };
    return {
        MemoryItem{
            .name = "OPC UA Server Settings",
            .files = {"server.json"},
            .initial = {{"server.json", controller::document_of(controller::ServerSettings{})}},
            .check = check},
        MemoryItem{.name = "Server certificate",
                   .group = MemoryGroup::ServerCertificate,
                   .folders = {"own/certs", "own/private"}},
        MemoryItem{.name = "Client certificates",
                   .group = MemoryGroup::SecurityProfile,
                   .folders = {"trusted/certs"},
                   .access = FileAccess::Everyone},
        MemoryItem{.name = "CA certificates",
                   .group = MemoryGroup::SecurityProfile,
                   .folders = {"issuers/certs"},
                   .access = FileAccess::Everyone},
        MemoryItem{.name = "Certificate revocation lists",
                   .group = MemoryGroup::SecurityProfile,
                   .folders = {"trusted/crl", "issuers/crl"},
                   .access = FileAccess::Everyone},
        MemoryItem{.name = "Security settings",
                   .group = MemoryGroup::SecurityProfile,
                   .files = {"security.json", "users.json"},
                   .initial = {{"security.json",
                                controller::document_of(controller::SecuritySettings{})}}},
        MemoryItem{.name = "Server options",
                   .files = {"options"},
                   .check = check_options,
                   .part = lines_part("server")},
        MemoryItem{.name = "Login options",
                   .group = MemoryGroup::SecurityProfile,
                   .files = {"login-options"},
                   .check = check_options,
                   .part = lines_part("login")},
        MemoryItem{.name = "Event log", .group = MemoryGroup::EventLog, .files = {"events.log"}}};
}

inline std::string port_document(std::uint32_t port)
{
    controller::ServerSettings settings;
    settings.is_used = true;
    settings.port = port;
    return controller::document_of(settings);
}

/// A controller's Storage and what can be done with it.
struct MemoryFixture {
    using Files = std::map<std::string, std::string>;

    void put(const std::string& name, const std::string& content)
    {
        const std::size_t slash = name.rfind('/');
        if (slash != std::string::npos) {
            static_cast<void>(storage.make_folder(name.substr(0, slash), FileAccess::Everyone));
        }
        static_cast<void>(
            storage.replace(name, std::as_bytes(std::span{content}), FileAccess::Owner));
    }
    void put_all(const Files& files)
    {
        for (const auto& [name, content] : files) {
            put(name, content);
        }
    }
    [[nodiscard]] Files files()
    {
        Files all;
        for (const std::string& name : storage.names()) {
            const auto bytes = read_file(storage, name, 1U << 20U);
            if (bytes) {
                all[name] = {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
            }
        }
        return all;
    }

    storage::MemoryStorage storage;
    RecordKeeper log;
    controller::MachineMemory memory{storage, "restore", machine_items(), log};
};

inline MemoryFixture::Files first_machine()
{
    return {{"server.json", port_document(4'841)},
            {"own/certs/own.der", "certificate 1"},
            {"own/private/own.pem", "key 1"},
            {"trusted/certs/a.der", "client a"},
            {"trusted/certs/b.der", "client b"},
            {"trusted/crl/a.crl", "list a"},
            {"issuers/certs/ca.der", "authority"},
            {"security.json", controller::document_of(controller::SecuritySettings{})},
            {"users.json", "users 1"},
            {"options", "server 1\nlogin 1\n"},
            {"events.log", "events 1"},
            {"log/execution.log", "records 1"}};
}

inline MemoryFixture::Files second_machine()
{
    return {{"server.json", port_document(4'999)}, {"own/certs/own.der", "certificate 2"},
            {"own/private/own.pem", "key 2"},      {"trusted/certs/b.der", "another b"},
            {"trusted/certs/c.der", "client c"},   {"users.json", "users 2"},
            {"options", "server 2\nlogin 2\n"},    {"events.log", "events 2"},
            {"log/execution.log", "records 2"}};
}

/// The second machine, after a backup of the first was restored to it.
inline MemoryFixture::Files second_restored()
{
    MemoryFixture::Files files = first_machine();
    const MemoryFixture::Files own = second_machine();
    for (const char* name :
         {"own/certs/own.der", "own/private/own.pem", "events.log", "log/execution.log"}) {
        files[name] = own.at(name);
    }
    return files;
}

} // namespace busbar::test
