#include <catch2/catch.hpp>

#include <algorithm>

#include <controller/backup/backup_file.hpp>

#include "memory_fixture.hpp"

namespace memory_part_test {

// Items that are parts of one file: settings of the server and of who may come in.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::MemoryFixture;
using busbar::test::Texts;
using controller::detail::SavedItem;

namespace {

using Bytes = std::vector<std::byte>;

struct SharedFile : MemoryFixture {
    SharedFile() { put_all(test::second_machine()); }

    [[nodiscard]] static Bytes backup_of(const std::string& options,
                                         const BackupChoice& choice = {})
    {
        MemoryFixture machine;
        machine.put("options", options);
        return machine.memory.backup({"press 4"}, choice).value();
    }
    [[nodiscard]] std::string options()
    {
        const auto all = files();
        const auto found = all.find("options");
        return found != all.end() ? found->second : "none";
    }
    [[nodiscard]] std::string restored(const Bytes& backup, const RestoreChoice& choice = {})
    {
        put("options", "server 2\nlogin 2\n");
        const auto done = memory.restore(backup, choice);
        return done ? options() : text(done.error());
    }
    /// Of the two items.
    [[nodiscard]] Texts differences(const Bytes& backup, const RestoreChoice& choice = {}) const
    {
        Texts lines;
        const auto found = memory.verify(backup, choice);
        for (const VerifiedItem& item : found.value()) {
            if (item.name.ends_with("options")) {
                lines.push_back(item.name + (item.differences.empty() ? "" : " differ"));
            }
        }
        return lines;
    }
};

SavedItem saved(const std::string& name, MemoryGroup group, const std::string& file,
                const std::string& content)
{
    const auto bytes = std::as_bytes(std::span{content});
    return {name, group, {{file, {bytes.begin(), bytes.end()}}}};
}

SavedItem server_options(const std::string& content)
{
    return saved("Server options", MemoryGroup::ServerSettings, "options", content);
}

Bytes backup_with(std::vector<SavedItem> items)
{
    return controller::detail::write_backup({{"press 4"}, true, std::move(items)});
}

/// As it was saved before the login was apart.
Bytes earlier_backup(const std::string& options)
{
    SavedItem users = saved("Security settings", MemoryGroup::SecurityProfile, "users.json", "all");
    return backup_with({server_options(options), std::move(users)});
}

constexpr RestoreChoice without_profile{.security_profile = false};

} // namespace

TEST_CASE_METHOD(SharedFile, "Security settings are restored by choice, whoever they share a file "
                             "with (8-2-2)")
{
    struct Row {
        const char* saved;
        const char* with_profile;
        const char* without_profile;
    };
    const Row rows[] = {
        {"server 1\nlogin 1\n", "server 1\nlogin 1\n", "login 2\nserver 1\n"},
        {"login 1\n", "login 1\n", "login 2\n"},
        {"server 1\n", "server 1\n", "login 2\nserver 1\n"},
        {"", "none", "login 2\n"},
    };
    for (const Row& row : rows) {
        INFO(row.saved);
        const Bytes backup = backup_of(row.saved);
        CHECK(restored(backup, without_profile) == row.without_profile);
        CHECK(differences(backup, without_profile) == Texts{"Server options"});
        CHECK(restored(backup) == row.with_profile);
        CHECK(differences(backup) == Texts{"Server options", "Login options"});
    }
}

TEST_CASE_METHOD(SharedFile, "A verification compares security settings by choice (8-2-2)")
{
    const Bytes backup = backup_of("server 2\nlogin 1\n");
    CHECK(differences(backup) == Texts{"Server options", "Login options differ"});
    CHECK(differences(backup, without_profile) == Texts{"Server options"});
    CHECK(differences(backup_of("server 1\nlogin 2\n")) ==
          Texts{"Server options differ", "Login options"});
    // Order and absence are no difference by themselves.
    CHECK(differences(backup_of("login 2\nserver 2\n")) ==
          Texts{"Server options", "Login options"});
    REQUIRE(storage.remove("options"));
    CHECK(differences(backup_of("")) == Texts{"Server options", "Login options"});
}

TEST_CASE_METHOD(SharedFile, "A backup for others has no security profile (8-2-1)")
{
    put_all(test::first_machine());
    const Bytes backup = memory.backup({"press 4"}, {.security_profile = false}).value();
    const std::string shown{reinterpret_cast<const char*>(backup.data()), backup.size()};
    for (const char* part : {"4841", "server 1", "events 1"}) {
        INFO(part);
        CHECK(shown.find(part) != std::string::npos);
    }
    for (const char* part : {"login", "client a", "list a", "authority", "anonymous", "users 1"}) {
        INFO(part);
        CHECK(shown.find(part) == std::string::npos);
    }
    put_all(test::second_machine());
    const auto before = files();
    const auto done = memory.restore(backup, {});
    REQUIRE(done);
    CHECK(*done == Restored::WithoutProfile);
    auto expected = before;
    expected["server.json"] = test::port_document(4'841);
    expected["options"] = "login 2\nserver 1\n";
    CHECK(files() == expected);
    // Nobody misses what nobody asked for.
    CHECK(memory.restore(backup, without_profile).value() == Restored::Data);
}

TEST_CASE_METHOD(SharedFile, "A backup of before security settings were apart is taken (8-2-3)")
{
    const Bytes backup = earlier_backup("server 1\nlogin 1\n");
    CHECK(restored(backup, without_profile) == "login 2\nserver 1\n");
    CHECK(differences(backup, without_profile) == Texts{"Server options"});
    CHECK(differences(backup) == Texts{"Server options", "Login options differ"});
    CHECK(restored(backup) == "server 1\nlogin 1\n");
    CHECK(differences(backup) == Texts{"Server options", "Login options"});
    CHECK(restored(earlier_backup("server 1\n")) == "server 1\n");
    SavedItem nothing{"Server options", MemoryGroup::ServerSettings, {}};
    CHECK(restored(backup_with({nothing, saved("Security settings", MemoryGroup::SecurityProfile,
                                               "users.json", "all")})) == "none");
}

TEST_CASE_METHOD(SharedFile, "No other item brings security settings (8-2-2)")
{
    // Whoever wrote it: the login is the login options' alone, and nobody asks for it here.
    CHECK(restored(backup_with({server_options("server 1\nlogin 1\n")})) == "login 2\nserver 1\n");
    CHECK(restored(backup_with({server_options("server 1\nlogin 1\n"),
                                saved("Login options", MemoryGroup::SecurityProfile,
                                      "login-options", "login 3\nserver 3\n")})) ==
          "server 1\nlogin 3\n");
    CHECK(restored(backup_with(
              {saved("Login options", MemoryGroup::SecurityProfile, "options", "login 1\n")})) ==
          "backup: found options, which is not a file of Login options");
}

TEST_CASE_METHOD(SharedFile, "Settings that do not go together are refused (8-2-2, 8-3)")
{
    const Bytes strict = backup_of("server strict\nlogin 1\n");
    put("options", "server 2\nlogin anybody\n");
    const auto before = files();
    const auto refused = memory.restore(strict, without_profile);
    REQUIRE_FALSE(refused);
    CHECK(text(refused.error()) == "backup: options: found anybody, expected a user");
    CHECK(files() == before);
    // With the profile they do.
    CHECK(memory.restore(strict, {}));
    CHECK(options() == "server strict\nlogin 1\n");
    CHECK(restored(backup_of("server strict\nlogin anybody\n")) ==
          "backup: options: found anybody, expected a user");
}

TEST_CASE_METHOD(SharedFile, "Clear All Memory leaves security settings if told to (8-3)")
{
    REQUIRE(memory.clear_all(false, MachineMode::Program));
    CHECK(options() == "login 2\n");
    REQUIRE(memory.clear_all(true, MachineMode::Program));
    CHECK(options() == "none");
}

} // namespace memory_part_test
