#include "machine_backup_fixture.hpp"

#include <catch2/catch.hpp>

namespace security_settings_backup_test {

// Settings of who may come in lie with all others, and are apart in a backup.

using namespace busbar;
using namespace busbar::test;

TEST_CASE_METHOD(BackupFixture, "machine backup: has security settings apart (3-2-9, 8-2-2)")
{
    const std::string begin = R"({"version":1,"settings":{)";
    const std::string open = R"("endpoint":["{ policy = 'None' }",)"
                             R"("{ mode = 'SignAndEncrypt', policy = 'Basic256Sha256' }"],)";
    const std::string named = R"("server.name":"Press 4")";
    const std::string anybody = R"(,"users.anonymous":"read")";
    put("settings.json", begin + open + named + anybody + "}}\n");
    const Bytes file = made();
    const std::string text{reinterpret_cast<const char*>(file.data()), file.size()};
    CHECK(text.find(named) != std::string::npos);
    CHECK(text.find(R"("name":"security-settings.json")") != std::string::npos);
    const Bytes given = *generate(Variant{"backup without security profile"});
    const std::string given_text{reinterpret_cast<const char*>(given.data()), given.size()};
    CHECK(given_text.find(named) != std::string::npos);
    for (const char* part : {"endpoint", "users", "client.der", "ca.crl"}) {
        INFO(part);
        CHECK(given_text.find(part) == std::string::npos);
    }

    const std::string strict = R"("users.anonymous":"no","users.certificates":"read")";
    put("settings.json", begin + R"("server.name":"Press 5",)" + strict + "}}\n");
    CHECK(take("verify", file) == "Good");
    CHECK(report().find(R"("Server settings","differences":["settings.json"])") !=
          std::string::npos);
    CHECK(report().find(R"("Security settings","differences":["security-settings.json"])") !=
          std::string::npos);
    const std::string no = "[Restore]\nUserProgram=yes\nOpcuaSPF=no\n";
    CHECK(take(("restore by command\n" + no).c_str(), file) == "Good");
    CHECK(there()["settings.json"] == begin + named + "," + strict + "}}\n");
    start();
    CHECK(take("restore by command\n[Restore]\nOpcuaSPF=perhaps\n", file) == "Bad_InvalidArgument");
    CHECK(report() == R"({"problem":"RestoreCommand.ini:2: OpcuaSPF: found perhaps, expected yes )"
                      R"(or no"})");
    CHECK(take("restore without security profile", file) == "Good");
    CHECK(there()["settings.json"] == begin + named + "," + strict + "}}\n");
    start();
    log.kinds.clear();
    CHECK(take("restore", given) == "Good");
    CHECK(report() == R"({"restored":true,"security_profile":false})");
    CHECK(log.kinds == std::vector<RecordKind>{RecordKind::SettingsChanged});
    CHECK(there()["settings.json"] == begin + named + "," + strict + "}}\n");
    start();
    CHECK(take("restore", file) == "Good");
    CHECK(there()["settings.json"] == begin + open + named + anybody + "}}\n");
    start();
    CHECK(take("clear", {}) == "Good");
    CHECK(there()["settings.json"] == begin + open + R"("users.anonymous":"read"}})" + "\n");
}

} // namespace security_settings_backup_test
