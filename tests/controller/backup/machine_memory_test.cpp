#include <catch2/catch.hpp>

#include <algorithm>

#include <controller/backup/backup_file.hpp>

#include "memory_fixture.hpp"
#include "sealed_backup.hpp"
#include "support/effort.hpp"

namespace machine_memory_test {

using namespace busbar;
using namespace busbar::controller;
using busbar::test::MemoryFixture;
using busbar::test::Texts;

namespace {

using Bytes = std::vector<std::byte>;
using Files = MemoryFixture::Files;

Bytes backup_of(const Files& files)
{
    MemoryFixture machine;
    machine.put_all(files);
    const auto made = machine.memory.backup({"press 4", DateTime::from_unix_seconds(1'000'000)});
    REQUIRE(made);
    return *made;
}

/// As a vendor's own tool could have written it, with the right checksums.
Bytes resealed(Bytes file)
{
    return test::TarBlocks{std::move(file)}.sealed();
}

controller::detail::SavedMemory saved(const std::string& item, MemoryGroup group,
                                      const std::string& name, const std::string& content)
{
    const auto bytes = std::as_bytes(std::span{content});
    return {{"press 4"}, true, {{item, group, {{name, {bytes.begin(), bytes.end()}}}}}};
}

std::string shown(const Bytes& bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool contains(const std::string& text, std::string_view part)
{
    return text.find(part) != std::string::npos;
}

struct SecondMachine : MemoryFixture {
    SecondMachine() { put_all(test::second_machine()); }

    [[nodiscard]] std::string refusal(const Bytes& backup, const RestoreChoice& choice = {})
    {
        const Files before = files();
        const auto restored = memory.restore(backup, choice);
        CHECK(files() == before);
        CHECK(log.take().empty());
        return restored ? "" : text(restored.error());
    }
};

} // namespace

TEST_CASE("What a backup has, and what not (8-2-1)")
{
    const std::string backup = shown(backup_of(test::first_machine()));
    for (const char* part : {"4841", "client a", "client b", "list a", "authority", "anonymous",
                             "users 1", "events 1", "press 4", "1970-01-12T13:46:40Z"}) {
        INFO(part);
        CHECK(contains(backup, part));
    }
    for (const char* part : {"certificate 1", "key 1", "own/", "records 1", "execution.log"}) {
        INFO(part);
        CHECK_FALSE(contains(backup, part));
    }
}

TEST_CASE_METHOD(SecondMachine, "A restore brings settings and security profile (8-2-2)")
{
    const auto restored = memory.restore(backup_of(test::first_machine()), {});
    REQUIRE(restored);
    CHECK(*restored == Restored::Data);
    CHECK(files() == test::second_restored());
    CHECK(log.take().empty());
    CHECK_FALSE(storage.is_open_to_others("users.json"));
    CHECK(storage.is_open_to_others("trusted/certs/a.der"));
}

TEST_CASE_METHOD(SecondMachine, "A restore leaves the security profile if told to (8-2-2)")
{
    REQUIRE(memory.restore(backup_of(test::first_machine()), {.security_profile = false}));
    Files expected = test::second_machine();
    expected["server.json"] = test::port_document(4'841);
    expected["options"] = "login 2\nserver 1\n";
    // Where there was none yet.
    expected["security.json"] = document_of(SecuritySettings{});
    CHECK(files() == expected);
}

TEST_CASE_METHOD(MemoryFixture, "A new controller takes over a backup (8-2-4)")
{
    Files expected = test::first_machine();
    for (const char* name :
         {"own/certs/own.der", "own/private/own.pem", "events.log", "log/execution.log"}) {
        expected.erase(name);
    }
    REQUIRE(memory.restore(backup_of(test::first_machine()), {}));
    CHECK(files() == expected);
    MachineSettings settings{storage, "server.json", "security.json", "settings"};
    REQUIRE(settings.load());
    CHECK(settings.server().port == 4'841);
}

TEST_CASE_METHOD(MemoryFixture, "A new controller without the profile has all settings (8-2-4)")
{
    REQUIRE(memory.restore(backup_of(test::first_machine()), {.security_profile = false}));
    CHECK(files() == Files{{"server.json", test::port_document(4'841)},
                           {"options", "server 1\n"},
                           {"security.json", document_of(SecuritySettings{})}});
}

TEST_CASE_METHOD(SecondMachine, "A verification lists what differs (8-2-2)")
{
    const Bytes backup = backup_of(test::first_machine());
    const auto found = memory.verify(backup, {});
    REQUIRE(found);
    Texts lines;
    for (const VerifiedItem& item : *found) {
        std::string line = item.name + ":";
        for (const std::string& name : item.differences) {
            line += " " + name;
        }
        lines.push_back(line);
    }
    CHECK(lines ==
          Texts{"OPC UA Server Settings: server.json",
                "Client certificates: trusted/certs/a.der trusted/certs/b.der trusted/certs/c.der",
                "CA certificates: issuers/certs/ca.der",
                "Certificate revocation lists: trusted/crl/a.crl",
                "Security settings: security.json users.json", "Server options: options",
                "Login options: login-options"});
    CHECK(files() == test::second_machine());

    const auto settings = memory.verify(backup, {.security_profile = false});
    REQUIRE(settings);
    CHECK(settings->size() == 2);

    REQUIRE(memory.restore(backup, {}));
    const auto same = memory.verify(backup, {});
    REQUIRE(same);
    CHECK(std::all_of(same->begin(), same->end(),
                      [](const VerifiedItem& item) { return item.differences.empty(); }));
}

TEST_CASE_METHOD(SecondMachine, "A backup without OPC UA clears the security (9-2-2, 95D40000)")
{
    MachineMemory without{storage, "restore", {}, log};
    const auto backup = without.backup({"old controller"});
    REQUIRE(backup);
    CHECK_FALSE(memory.verify(*backup, {}));
    // The choice is about what the file has.
    const auto restored = memory.restore(*backup, {.security_profile = GENERATE(true, false)});
    REQUIRE(restored);
    CHECK(*restored == Restored::Nothing);
    CHECK(log.take() == Texts{"SecurityCleared"});
    CHECK(files() == Files{{"server.json", document_of(ServerSettings{})},
                           {"security.json", document_of(SecuritySettings{})},
                           {"events.log", "events 2"},
                           {"log/execution.log", "records 2"}});
}

TEST_CASE_METHOD(SecondMachine, "A download without OPC UA clears the security (9-2-2, 95D40000)")
{
    REQUIRE(memory.clear_security());
    CHECK(log.take() == Texts{"SecurityCleared"});
    CHECK(files().count("users.json") == 0);
    CHECK(files().count("own/private/own.pem") == 0);
}

TEST_CASE_METHOD(SecondMachine, "Clear All Memory with certificate and security profile (8-3)")
{
    REQUIRE(memory.clear_all(true, MachineMode::Program));
    CHECK(files() == Files{{"server.json", document_of(ServerSettings{})},
                           {"security.json", document_of(SecuritySettings{})},
                           {"events.log", "events 2"},
                           {"log/execution.log", "records 2"}});
    CHECK(log.take() == Texts{"SecurityCleared"});
}

TEST_CASE_METHOD(SecondMachine, "Clear All Memory without certificate and security profile (8-3)")
{
    REQUIRE(memory.clear_all(false, MachineMode::Program));
    Files expected = test::second_machine();
    expected["server.json"] = document_of(ServerSettings{});
    expected["security.json"] = document_of(SecuritySettings{});
    expected["options"] = "login 2\n";
    CHECK(files() == expected);
    CHECK(log.take().empty());
    MachineSettings settings{storage, "server.json", "security.json", "settings"};
    REQUIRE(settings.load());
    CHECK_FALSE(settings.server().is_used);
}

TEST_CASE_METHOD(SecondMachine, "Clear All Memory is refused in RUN mode (8-3)")
{
    const auto cleared = memory.clear_all(true, MachineMode::Run);
    REQUIRE_FALSE(cleared);
    CHECK(cleared.error().status == status::Bad_InvalidState);
    CHECK(files() == test::second_machine());
}

TEST_CASE_METHOD(SecondMachine, "A backup with items that nobody knows is refused (8-2-3)")
{
    CHECK(refusal(controller::detail::write_backup(
              saved("Recipes", MemoryGroup::ServerSettings, "recipes.json", "{}"))) ==
          "backup: found Recipes, which this controller does not have");
    // Nobody asked for these.
    CHECK(memory.restore(controller::detail::write_backup(
                             saved("Other logs", MemoryGroup::EventLog, "other.log", "x")),
                         {}));
}

TEST_CASE_METHOD(SecondMachine, "Items that a backup does not know stay (8-2-3)")
{
    REQUIRE(memory.restore(
        controller::detail::write_backup(saved("Client certificates", MemoryGroup::SecurityProfile,
                                               "trusted/certs/z.der", "client z")),
        {}));
    Files expected = test::second_machine();
    expected.erase("trusted/certs/b.der");
    expected.erase("trusted/certs/c.der");
    expected["trusted/certs/z.der"] = "client z";
    expected["security.json"] = document_of(SecuritySettings{});
    CHECK(files() == expected);
}

TEST_CASE_METHOD(SecondMachine, "A backup cannot write anywhere else (8-2-2)")
{
    const std::string name =
        GENERATE("own/private/own.pem", "events.log", "trusted/certs/deeper/a.der", "restore/x",
                 "../a.der", "trusted/certs/../x", "");
    INFO(name);
    CHECK_FALSE(refusal(controller::detail::write_backup(
                            saved("Client certificates", MemoryGroup::SecurityProfile, name, "x")))
                    .empty());
}

TEST_CASE_METHOD(SecondMachine, "A backup with settings that are wrong is refused (8-2-2)")
{
    const auto with = [&](const std::string& content) {
        return refusal(controller::detail::write_backup(
            saved("OPC UA Server Settings", MemoryGroup::ServerSettings, "server.json", content)));
    };
    CHECK(contains(with("{}"), "backup: server.json"));
    CHECK(contains(with(test::port_document(80)), "port: found 80"));
}

TEST_CASE_METHOD(SecondMachine, "A backup that is cut or damaged changes nothing (8-2-2)")
{
    const Bytes good = backup_of(test::first_machine());
    const Files before = files();
    const test::Turns turns{"damaged backup", 61};
    for (std::size_t at = turns.first; at < good.size(); at += turns.stride) {
        const Bytes cut{good.begin(), good.begin() + static_cast<std::ptrdiff_t>(at)};
        REQUIRE_FALSE(memory.restore(cut, {}));
        Bytes bad = good;
        bad[at] ^= std::byte{0x10};
        REQUIRE_FALSE(memory.restore(bad, {}));
    }
    for (std::size_t size = 0; size < good.size(); size += 512) {
        const Bytes cut{good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)};
        REQUIRE_FALSE(memory.restore(cut, {}));
    }
    CHECK(files() == before);
    CHECK(log.take().empty());
}

TEST_CASE("A backup that was forged is restored whole or not at all (8-2-2)")
{
    const Bytes good = backup_of(test::first_machine());
    std::size_t restored = 0;
    const test::Turns turns{"forged backup", 61};
    for (std::size_t at = turns.first; at < good.size(); at += turns.stride) {
        Bytes forged = good;
        forged[at] ^= std::byte{0x01};
        forged = resealed(forged);
        SecondMachine machine;
        const auto done = machine.memory.restore(forged, {});
        if (!done) {
            REQUIRE(machine.files() == test::second_machine());
            continue;
        }
        ++restored;
        const auto same = machine.memory.verify(forged, {});
        REQUIRE(same);
        for (const VerifiedItem& item : *same) {
            REQUIRE(item.differences.empty());
        }
    }
    CHECK(restored > 0); // the contents of certificates are not looked at
}

TEST_CASE_METHOD(SecondMachine, "A backup larger than the limits is refused (8-2-2)")
{
    const Bytes backup = backup_of(test::first_machine());
    MemoryLimits limits;
    SECTION("bytes")
    {
        limits.max_backup_size = backup.size() - 1;
    }
    SECTION("bytes of a file")
    {
        limits.max_file_size = 10;
    }
    SECTION("files")
    {
        limits.max_files = 3;
    }
    SECTION("names")
    {
        limits.max_names_size = 40;
    }
    MachineMemory small{storage, "restore", test::machine_items(), log, limits};
    CHECK_FALSE(small.restore(backup, {}));
    CHECK(files() == test::second_machine());
    // What could not be restored is not made.
    MemoryFixture first;
    first.put_all(test::first_machine());
    MachineMemory small_first{first.storage, "restore", test::machine_items(), log, limits};
    CHECK_FALSE(small_first.backup({"press 4", DateTime::from_unix_seconds(1'000'000)}));
}

TEST_CASE_METHOD(SecondMachine, "A file whose name is no text is not lost silently (8-2-1)")
{
    put("trusted/certs/\xFF.der", "x");
    const auto made = memory.backup({});
    REQUIRE_FALSE(made);
    CHECK(contains(text(made.error()), R"(\xFF.der)"));
}

TEST_CASE("What each operation includes (3-2-9)")
{
    struct Row {
        const char* file;
        bool is_saved;
        bool is_restored;
        bool is_transferred; // from a card, without the security profile
        bool is_cleared;
        bool is_cleared_by_choice;
    };
    const std::vector<Row> rows{
        {"server.json", true, true, true, true, true},
        {"own/certs/own.der", false, false, false, false, true},
        {"trusted/certs/b.der", true, true, false, false, true},
        {"issuers/certs/ca.der", true, true, false, false, true},
        {"trusted/crl/a.crl", true, true, false, false, true},
        {"users.json", true, true, false, false, true},
        {"events.log", true, false, false, false, false}, // 8-2-1 and 8-2-2
        {"log/execution.log", false, false, false, false, false},
    };
    const Files first = test::first_machine();
    Files other = first;
    for (auto& [name, content] : other) {
        content = name == "server.json" ? test::port_document(5'000) : "other " + content;
    }
    const Bytes backup = backup_of(first);
    const auto changes = [&](const Row& row, auto change) {
        MemoryFixture machine;
        machine.put_all(other);
        REQUIRE(change(machine.memory));
        const Files found = machine.files();
        return found.count(row.file) == 0 || found.at(row.file) != other.at(row.file);
    };
    for (const Row& row : rows) {
        INFO(row.file);
        CHECK(contains(shown(backup), row.file) == row.is_saved);
        CHECK(changes(row, [&](auto& memory) { return !!memory.restore(backup, {}); }) ==
              row.is_restored);
        CHECK(changes(row, [&](auto& memory) { return !!memory.restore(backup, {false}); }) ==
              row.is_transferred);
        CHECK(changes(row, [](auto& memory) {
                  return !!memory.clear_all(false, MachineMode::Program);
              }) == row.is_cleared);
        CHECK(changes(row, [](auto& memory) {
                  return !!memory.clear_all(true, MachineMode::Program);
              }) == row.is_cleared_by_choice);
    }
}

} // namespace machine_memory_test
