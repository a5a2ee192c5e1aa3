#pragma once

#include "product/machine/machine_backup.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <busbar/administration/audit_log.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/event.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/ids.hpp>

#include "product/machine/machine_files.hpp"
#include "product/machine/machine_items.hpp"
#include "support/temporary_folder.hpp"

namespace busbar::test {

using namespace busbar::product;

using Bytes = std::vector<std::byte>;
using Files = std::map<std::string, std::string>;

struct StillClock final : WallClock {
    [[nodiscard]] DateTime now() const override { return DateTime::from_unix_seconds(1'000'000); }
};

struct RecordedLog final : LogSink {
    void write(LogLevel, std::string_view, std::string_view text) override
    {
        lines += std::string{text} + "\n";
    }
    void record(const Record& record) override
    {
        kinds.push_back(record.kind);
        user = record.actor.user;
    }
    [[nodiscard]] bool wants(RecordKind) const override { return true; }

    std::string lines;
    std::vector<RecordKind> kinds;
    std::string user; // of the last record
};

inline const Files before{
    {"settings.json", R"({"version":1,"settings":{"server.name":"Press 4"}})"
                      "\n"},
    {"users.json", R"({"version":1,"users":[]})"},
    {"trusted/certs/client.der", "client"},
    {"issuers/crl/ca.crl", "list"},
    {"users/trusted/certs/pat.der", "pat"},
    {"own/certs/own.der", "own"},
    {"rejected/certs/stranger.der", "stranger"},
    {"setup.code", "code"},
};

/// A machine's memory, of which the settings decide what makes sense.
struct BackupFixture {
    BackupFixture()
    {
        const std::string file = folder.path.string() + "/press.toml";
        std::ofstream{file} << "certificates.folder = \"" + folder.path.string() + "/pki\"\n";
        settings = std::make_unique<Settings>(file);
        put_all(before);
        static_cast<void>(events.replace("events.log", bytes_of("events"), FileAccess::Owner));
        start();
    }

    void start()
    {
        audit.attach(audit_events, "urn:busbar:test:press");
        gate = std::make_unique<StorageGate>(files);
        backup = std::make_unique<MachineBackup>(MachineBackup::Needs{
            .files = all,
            .gate = *gate,
            .items = machine_items(*settings, state, prepared),
            .preparation =
                [this](std::span<const std::byte> file) {
                    return [this, file] {
                        const ProgramBase base{{*controller::CheckedProgram::create({})},
                                               PlcTrial{settings->config()}};
                        prepare_restored(base, file, *prepared);
                    };
                },
            .controller = "Press 4",
            .clock = clock,
            .log = audit,
            .mode = [this] { return mode; },
            .hold_files =
                [this](FunctionRef<void()> act) {
                    ++holds;
                    act();
                },
            .values_replaced = [] {},
            .replaced = [this] { ++restarts; }});
    }

    static std::span<const std::byte> bytes_of(std::string_view text)
    {
        return std::as_bytes(std::span{text.data(), text.size()});
    }
    void put(const std::string& name, const std::string& content)
    {
        const std::size_t slash = name.rfind('/');
        if (slash != std::string::npos) {
            REQUIRE(files.make_folder(name.substr(0, slash), FileAccess::Everyone));
        }
        REQUIRE(files.replace(name, bytes_of(content), FileAccess::Owner));
    }
    void put_all(const Files& some)
    {
        for (const auto& [name, content] : some) {
            put(name, content);
        }
    }
    [[nodiscard]] Files there()
    {
        Files found;
        for (const std::string& name : files.names()) {
            const auto bytes = read_file(files, name, 10'000);
            REQUIRE(bytes);
            found[name] = {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
        }
        return found;
    }

    [[nodiscard]] Result<Bytes> generate(const Variant& options, const NodeId& session = {1, 1})
    {
        return backup->generate({options, user, session, &method}, 1'000'000);
    }
    /// The backup of somebody who does not look at his settings.
    [[nodiscard]] Bytes with_settings(const std::string& document)
    {
        put("settings.json", document);
        const controller::MachineMemory memory{
            files, "transaction", {{.name = "Server settings", .files = {"settings.json"}}}, log};
        auto file = memory.backup({"Press 4"});
        REQUIRE(file);
        return *std::move(file);
    }
    [[nodiscard]] std::string report(const NodeId& session = {1, 1})
    {
        const auto bytes = generate(Variant{"report"}, session);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{name(bytes.error())};
    }
    [[nodiscard]] std::string take(const char* options, std::span<const std::byte> bytes,
                                   const NodeId& session = {1, 1})
    {
        const Variant wish{options};
        const administration::TransferRequest request{wish, user, session, &method};
        const StatusCode may = backup->may_take(request);
        if (may.is_bad()) {
            return std::string{name(may)};
        }
        if (const auto prepare = backup->preparation(request, bytes)) {
            prepare();
        }
        return std::string{name(backup->take(request, bytes))};
    }
    /// The types of the audit events since the last call.
    [[nodiscard]] std::vector<NodeId> audited()
    {
        std::vector<NodeId> types;
        server::Event event;
        while (audit_events->next(event)) {
            types.push_back(event.event_type);
        }
        return types;
    }
    [[nodiscard]] Bytes made()
    {
        auto bytes = generate(Variant{});
        REQUIRE(bytes);
        return *std::move(bytes);
    }
    void change()
    {
        put("settings.json", R"({"version":1,"settings":{"server.port":4901}})");
        put("users.json", R"({"version":1,"users":[ ]})");
        put("roles.json", R"({"version":1,"roles":[]})");
        put("trusted/certs/other.der", "other");
    }

    test::TemporaryFolder folder;
    std::unique_ptr<Settings> settings;
    std::shared_ptr<RestoredProgram> prepared = std::make_shared<RestoredProgram>();
    storage::MemoryStorage files;
    storage::MemoryStorage events;
    storage::MemoryStorage state;
    MachineFiles all{files, events};
    StillClock clock;
    RecordedLog log;
    administration::AuditLog audit{log};
    std::shared_ptr<server::EventQueue> audit_events{
        std::make_shared<server::EventQueue>(clock, nullptr, 16)};
    server::UserIdentity user{.name = "chief"};
    NodeId method{0, id::TemporaryFileTransferType_CloseAndCommit};
    controller::MachineMode mode{controller::MachineMode::Program};
    int holds{0};
    int restarts{0};
    std::unique_ptr<StorageGate> gate;
    std::unique_ptr<MachineBackup> backup;
};

} // namespace busbar::test
