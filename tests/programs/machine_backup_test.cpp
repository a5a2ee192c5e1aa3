#include "machine_backup_fixture.hpp"

#include <catch2/catch.hpp>

#include <busbar/administration/managed_certificates.hpp>
#include <busbar/administration/role_list.hpp>

#include "support/effort.hpp"

namespace machine_backup_test {

using namespace busbar;
using namespace busbar::test;

TEST_CASE_METHOD(BackupFixture, "machine backup: has what it should, and no key (8-2-1)")
{
    const Bytes file = made();
    const std::string text{reinterpret_cast<const char*>(file.data()), file.size()};
    CHECK(holds == 1);
    for (const char* part :
         {"Press 4", "settings.json", "users.json", "trusted/certs/client.der",
          "issuers/crl/ca.crl", "users/trusted/certs/pat.der", "event-log/events.log"}) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
    for (const char* part : {"own/certs", "rejected/certs", "setup.code"}) {
        INFO(part);
        CHECK(text.find(part) == std::string::npos);
    }
    CHECK(backup->generate({Variant{}, user, NodeId{1, 1}}, file.size() - 1).error() ==
          status::Bad_EncodingLimitsExceeded);
    CHECK(there() == before);
}

TEST_CASE_METHOD(BackupFixture, "machine backup: a verification tells what differs (8-2-2)")
{
    const Bytes file = made();
    CHECK(take("verify", file) == "Good");
    CHECK(report().find(R"({"name":"Users","differences":[]})") != std::string::npos);
    change();
    const Files changed = there();
    CHECK(take("verify", file) == "Good");
    CHECK(report() == R"({"items":[{"name":"Server settings","differences":["settings.json"]},)"
                      R"({"name":"Program","differences":[]},)"
                      R"({"name":"Client certificates","differences":["trusted/certs/other.der"]},)"
                      R"({"name":"CA certificates","differences":[]},)"
                      R"({"name":"Certificate revocation lists","differences":[]},)"
                      R"({"name":"User certificates","differences":[]},)"
                      R"({"name":"Security settings","differences":[]},)"
                      R"({"name":"Users","differences":["users.json"]},)"
                      R"({"name":"Roles","differences":["roles.json"]}]})");
    CHECK(report({1, 2}) == "Bad_NotFound");
    CHECK(take("verify without security profile", file) == "Good");
    CHECK(report() == R"({"items":[{"name":"Server settings","differences":["settings.json"]},)"
                      R"({"name":"Program","differences":[]}]})");
    CHECK(there() == changed);
    CHECK_FALSE(gate->is_closed());
    CHECK(restarts == 0);
}

TEST_CASE_METHOD(BackupFixture, "machine backup: what is restored stays until the restart")
{
    const Bytes file = made();
    change();
    mode = controller::MachineMode::Run; // which restores, but does not clear
    CHECK(take("restore", file) == "Good");
    CHECK(report() == R"({"restored":true})");
    CHECK(there() == before);
    CHECK(restarts == 1);
    CHECK(log.lines.find("a restart, which is due") != std::string::npos);
    using Kinds = std::vector<RecordKind>;
    CHECK(log.kinds == Kinds{RecordKind::SettingsChanged, RecordKind::UsersChanged,
                             RecordKind::RolesChanged, RecordKind::TrustListUpdated});
    CHECK(log.user == "chief");
    log.kinds.clear();

    // What the server has in memory does not come back over it.
    administration::RoleList roles{*gate, "roles.json"};
    const auto added = roles.add("Fitter", "");
    REQUIRE_FALSE(added);
    CHECK(added.error().status == status::Bad_InvalidState);
    CHECK(there() == before);
    CHECK(take("restore", file) == "Bad_InvalidState");
    CHECK(take("clear", {}) == "Bad_InvalidState");
    CHECK(take("verify", file) == "Good");
    CHECK(log.kinds.empty());

    start();
    REQUIRE(administration::RoleList{*gate, "roles.json"}.add("Fitter", ""));
    CHECK(take("restore without security profile", file) == "Good");
    CHECK(there().contains("roles.json"));
    CHECK(restarts == 2);
    CHECK(log.kinds == Kinds{RecordKind::SettingsChanged});
}

TEST_CASE_METHOD(BackupFixture, "machine backup: a Method has one audit event (Part 4, 6.5.9)")
{
    // Which it gets as a Call. Trust lists that it has changed have another one (Part 12,
    // 7.8.2.13).
    using Types = std::vector<NodeId>;
    const Types trust_lists{NodeId{0, id::TrustListUpdatedAuditEventType}};
    const Bytes file = made();
    CHECK(take("verify", file) == "Good");
    CHECK(audited() == Types{});
    CHECK(take("restore", file) == "Good");
    CHECK(audited() == trust_lists);
    start();
    CHECK(take("restore without security profile", file) == "Good");
    CHECK(audited() == Types{});
    start();
    CHECK(take("clear", {}) == "Good");
    CHECK(audited() == Types{});
    start();
    CHECK(take("clear with security", {}) == "Good");
    CHECK(audited() == trust_lists);
}

TEST_CASE_METHOD(BackupFixture, "machine backup: what makes no sense changes nothing")
{
    const Bytes file = made();
    Bytes damaged = file;
    damaged[damaged.size() / 2] ^= std::byte{1};
    const Bytes senseless = with_settings(R"({"version":1,"settings":{"limits.sessions":0}})");
    const Bytes unfit = with_settings(R"({"version":1,"settings":{"server.address":"here"}})");
    CHECK(generate(Variant{}).has_value());
    put("settings.json", "{");
    CHECK(generate(Variant{}).error() == status::Bad_ConfigurationError);
    put_all(before);
    put("users.json", R"({"version":1,"users":[{"name":"pat"}]})");
    const Bytes without_password = made();
    put_all(before);
    const Bytes nothing;

    const struct {
        const Bytes& file;
        const char* answer;
        const char* said;
    } rows[] = {{damaged, "Bad_ConfigurationError", "backup"},
                {senseless, "Bad_OutOfRange", "limits.sessions"},
                {unfit, "Bad_ConfigurationError", "found 'here'"},
                {without_password, "Bad_ConfigurationError", "password_hash"},
                {nothing, "Bad_ConfigurationError", "backup"}};
    for (const auto& [bytes, answer, said] : rows) {
        CHECK(take("restore", bytes) == answer);
        INFO(report());
        CHECK(report().find(R"({"problem":")") == 0);
        CHECK(report().find(said) != std::string::npos);
        CHECK(log.lines.find("restore: nothing was changed: ") != std::string::npos);
    }
    CHECK(there() == before);
    CHECK_FALSE(gate->is_closed());
    CHECK(restarts == 0);
    CHECK(take("restore", file) == "Good");
}

TEST_CASE_METHOD(BackupFixture, "machine backup: clears all memory in PROGRAM mode (8-3)")
{
    mode = controller::MachineMode::Run;
    CHECK(take("clear", {}) == "Bad_InvalidState");
    CHECK(take("clear with security", {}) == "Bad_InvalidState");
    const Variant wish{"clear"};
    CHECK(backup->take({wish, user, NodeId{1, 1}}, {}) == status::Bad_InvalidState);
    CHECK(there() == before);

    mode = controller::MachineMode::Program;
    CHECK(take("clear", bytes_of("x")) == "Bad_InvalidArgument");
    CHECK(there() == before);
    CHECK(take("clear", {}) == "Good");
    CHECK(report() == R"({"cleared":true})");
    Files expected = before;
    expected.erase("settings.json");
    CHECK(there() == expected);
    CHECK(log.kinds == std::vector<RecordKind>{RecordKind::SettingsChanged});
    CHECK(restarts == 1);

    start();
    log.kinds.clear();
    CHECK(take("clear with security", {}) == "Good");
    CHECK(files.names().empty());
    CHECK(events.names() == std::vector<std::string>{"events.log"});
    // A new certificate is made, and recorded, at the start after it.
    CHECK(log.kinds == std::vector<RecordKind>{RecordKind::SecurityCleared,
                                               RecordKind::SettingsChanged,
                                               RecordKind::UsersChanged, RecordKind::RolesChanged,
                                               RecordKind::TrustListUpdated});
}

TEST_CASE_METHOD(BackupFixture, "machine backup: knows its options, and who may use them (8-1)")
{
    CHECK(report() == "Bad_NotFound");
    CHECK(take("restore everything", {}) == "Bad_InvalidArgument");
    CHECK(report().find("options: found an unknown option of a backup") != std::string::npos);
    CHECK(generate(Variant{"verify"}).error() == status::Bad_InvalidArgument);
    CHECK(generate(Variant{true}).error() == status::Bad_InvalidArgument);
    const Variant number{std::int32_t{1}};
    CHECK(backup->may_take({number, user, NodeId{}}) == status::Bad_InvalidArgument);
    const auto transfer = backup->transfer();
    CHECK(transfer.name == "Backup");
    CHECK(transfer.owner == backup.get());
    const NodeId administrator{0, 15'704}; // SecurityAdmin
    CHECK(transfer.readers == std::vector<NodeId>{administrator});
    CHECK(transfer.writers == std::vector<NodeId>{administrator});
}

TEST_CASE_METHOD(BackupFixture, "machine backup: a power cut restores all or nothing (8-2-2)")
{
    const Bytes file = made();
    change();
    const Files changed = there();
    const Turns turns{"machine backup", 5};
    std::size_t cuts = turns.first;
    for (bool was_cut = true; was_cut; cuts += turns.stride) {
        REQUIRE(cuts < 10'000);
        const std::size_t begin = files.steps();
        files.cut_power_after(cuts);
        const std::string answer = take("restore", file);
        was_cut = files.steps() - begin >= cuts;
        files.restore_power();
        REQUIRE(administration::finish_changes(files)); // as the next start does
        const Files now = there();
        CHECK((now == before || now == changed));
        CHECK((answer != "Good" || now == before));
        for (const std::string& name : files.names()) {
            REQUIRE(files.remove(name));
        }
        put_all(before);
        change();
        start();
    }
    CHECK(cuts > 100);
}

TEST_CASE("machine files: the event log is read, and changed by nobody")
{
    storage::MemoryStorage files;
    storage::MemoryStorage events;
    REQUIRE(events.replace("events.log", {}, FileAccess::Owner));
    MachineFiles all{files, events};
    CHECK(all.entry("event-log/events.log"));
    CHECK(all.list("event-log", 9)->entries.size() == 1);
    CHECK(all.place("event-log/events.log") == events.place("events.log"));
    CHECK(all.place("event-logs") == files.place("event-logs"));
    const std::string log = "event-log/events.log";
    CHECK(all.replace(log, {}, FileAccess::Owner).error() == StorageError::Protected);
    CHECK(all.append(log, {}, FileAccess::Owner).error() == StorageError::Protected);
    CHECK(all.move(log, "here", WhenThere::Replace).error() == StorageError::Protected);
    CHECK(all.remove(log).error() == StorageError::Protected);
    CHECK(all.make_folder("event-log/more", FileAccess::Owner).error() == StorageError::Protected);
    CHECK(all.close_to_others(log).error() == StorageError::Protected);
    REQUIRE(all.replace("users.json", {}, FileAccess::Owner));
    CHECK(all.move("users.json", log, WhenThere::Replace).error() == StorageError::Protected);
    CHECK(files.names() == std::vector<std::string>{"users.json"});
    CHECK(events.names() == std::vector<std::string>{"events.log"});
}

} // namespace machine_backup_test
