#include <catch2/catch.hpp>

#include <functional>
#include <map>
#include <optional>
#include <span>

#include <busbar/controller/machine_settings.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "support/effort.hpp"

namespace machine_settings_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

struct SettingsWorld {
    [[nodiscard]] std::string read(const char* name)
    {
        const auto bytes = read_file(storage, name, 65'536);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{};
    }
    void write(const char* name, const std::string& document)
    {
        REQUIRE(storage.replace(name, std::as_bytes(std::span{document}), FileAccess::Owner));
    }
    [[nodiscard]] MachineSettings restarted()
    {
        return MachineSettings{storage, "server.json", "security.json", "transaction"};
    }

    storage::MemoryStorage storage;
    MachineSettings settings{storage, "server.json", "security.json", "transaction"};
};

ServerSettings machine_server()
{
    return {true, 4'850, {true, 50, 1'000}};
}

SecuritySettings machine_security()
{
    return {true, {{MessageSecurityMode::None, "None"}, {}}};
}

template <typename Settings, typename Change>
std::string problem_with(Change change)
{
    Settings settings;
    change(settings);
    const auto checked = check(settings);
    return checked ? "" : text(checked.error());
}

template <typename Change>
std::string server_problem(Change change)
{
    return problem_with<ServerSettings>(change);
}

template <typename Change>
std::string security_problem(Change change)
{
    return problem_with<SecuritySettings>(change);
}

} // namespace

TEST_CASE("Server settings have these defaults (3-2-2)")
{
    const ServerSettings settings;
    CHECK_FALSE(settings.is_used);
    CHECK(settings.port == 4'840);
    CHECK_FALSE(settings.execution_log.is_recorded);
    CHECK(settings.execution_log.files == 24);
    CHECK(settings.execution_log.records == 12'000);
    CHECK(check(settings));
}

TEST_CASE("The port is 1,025 to 65,535 (3-2-2)")
{
    const auto with = [](std::uint32_t port) {
        return server_problem([&](ServerSettings& settings) { settings.port = port; });
    };
    CHECK(with(1'024) == "port: found 1024, expected 1025 to 65535 (Bad_OutOfRange)");
    CHECK(with(1'025).empty());
    CHECK(with(65'535).empty());
    CHECK(with(65'536) == "port: found 65536, expected 1025 to 65535 (Bad_OutOfRange)");
}

TEST_CASE("The execution log has 2 to 100 files of 100 to 65,536 records (3-2-2)")
{
    const auto with = [](std::uint32_t files, std::uint32_t records) {
        return server_problem([&](ServerSettings& settings) {
            settings.execution_log.files = files;
            settings.execution_log.records = records;
        });
    };
    CHECK(with(1, 100) == "execution_log.files: found 1, expected 2 to 100 (Bad_OutOfRange)");
    CHECK(with(2, 100).empty());
    CHECK(with(100, 65'536).empty());
    CHECK(with(101, 100) == "execution_log.files: found 101, expected 2 to 100 (Bad_OutOfRange)");
    CHECK(with(2, 99) == "execution_log.records: found 99, expected 100 to 65536 (Bad_OutOfRange)");
    CHECK(with(2, 65'537) ==
          "execution_log.records: found 65537, expected 100 to 65536 (Bad_OutOfRange)");
}

TEST_CASE("By default nobody comes in anonymously or without security (3-2-6)")
{
    const SecuritySettings settings;
    CHECK_FALSE(settings.allows_anonymous);
    CHECK(settings.allowed.size() >= 2);
    for (const MessageSecurity& each : settings.allowed) {
        CHECK(each.mode != MessageSecurityMode::None);
        CHECK(each.policy != "Basic128Rsa15");
        CHECK(each.policy != "Basic256");
    }
    CHECK(check(settings));
    CHECK(text(settings.allowed.front()) == "Sign - Basic256Sha256");
}

TEST_CASE("Security policies are checked as a set (3-2-6)")
{
    const auto with = [](std::vector<MessageSecurity> allowed) {
        return security_problem(
            [&](SecuritySettings& settings) { settings.allowed = std::move(allowed); });
    };
    using Mode = MessageSecurityMode;
    CHECK(with({{Mode::None, "None"}}).empty());
    CHECK(with({{Mode::Sign, "Basic256Sha256"}, {Mode::None, "None"}}).empty());
    CHECK(with({}) == "allowed: found nothing, expected at least one way to connect");
    CHECK(with({{Mode::Sign, "Basic512"}}) ==
          "allowed[0]: found Basic512, expected the name of a policy of this build");
    CHECK(with({{Mode::Sign, "Basic256Sha256"}, {Mode::Sign, "None"}}) ==
          "allowed[1]: found Sign with policy None, expected None with None and Sign or "
          "SignAndEncrypt with another policy");
    CHECK_FALSE(with({{Mode::None, "Basic256Sha256"}}).empty());
    CHECK_FALSE(with({{Mode::Invalid, "None"}}).empty());
    CHECK(with({{Mode::Sign, "Basic256Sha256"}, {Mode::Sign, "Basic256Sha256"}}) ==
          "allowed[1]: found Sign - Basic256Sha256 twice, expected each once");
}

TEST_CASE_METHOD(SettingsWorld, "Settings are not changed in RUN mode (3-2-2, 3-2-6)")
{
    const auto server = settings.transfer(machine_server(), MachineMode::Run);
    REQUIRE_FALSE(server);
    CHECK(server.error().status == status::Bad_InvalidState);
    CHECK_FALSE(settings.transfer(machine_security(), MachineMode::Run));
    CHECK(settings.server() == ServerSettings{});
    CHECK(storage.names().empty());
}

TEST_CASE_METHOD(SettingsWorld, "Settings are transferred as a whole and kept (3-2-6)")
{
    REQUIRE(settings.load());
    CHECK(settings.server() == ServerSettings{});
    REQUIRE(settings.transfer(machine_server(), MachineMode::Program));
    REQUIRE(settings.transfer(machine_security(), MachineMode::Program));
    CHECK(settings.server() == machine_server());
    MachineSettings later = restarted();
    REQUIRE(later.load());
    CHECK(later.server() == machine_server());
    CHECK(later.security() == machine_security());

    ServerSettings wrong = machine_server();
    wrong.port = 80;
    CHECK_FALSE(later.transfer(wrong, MachineMode::Program));
    CHECK(later.server() == machine_server());
    REQUIRE(later.load());
    CHECK(later.server() == machine_server());
}

TEST_CASE_METHOD(SettingsWorld, "A file of settings that is cut or damaged is an error (7-1-6)")
{
    REQUIRE(settings.transfer(machine_server(), MachineMode::Program));
    REQUIRE(settings.transfer(machine_security(), MachineMode::Program));
    for (const char* name : {"server.json", "security.json"}) {
        const std::string good = read(name);
        const std::string content = good.substr(0, good.size() - 1); // a line's end is nothing
        for (std::size_t size = 0; size < content.size(); ++size) {
            write(name, content.substr(0, size));
            CHECK_FALSE(settings.load());
        }
        for (std::size_t at = 0; at < content.size(); ++at) {
            for (const unsigned bit : {0U, 1U, 3U, 6U, 7U}) {
                std::string bad = content;
                bad[at] = static_cast<char>(static_cast<unsigned char>(bad[at]) ^ (1U << bit));
                write(name, bad);
                if (settings.load()) {
                    FAIL(name << " is read with bit " << bit << " of byte " << at << " wrong");
                }
            }
        }
        CHECK(settings.server() == machine_server());
        CHECK(settings.security() == machine_security());
        write(name, good);
        REQUIRE(settings.load());
    }
}

TEST_CASE_METHOD(SettingsWorld, "One file of settings without the other is an error (7-1-6)")
{
    REQUIRE(settings.transfer(machine_server(), MachineMode::Program));
    REQUIRE(settings.load());
    const char* const name = GENERATE("server.json", "security.json");
    REQUIRE(storage.remove(name));
    MachineSettings later = restarted();
    const auto loaded = later.load();
    REQUIRE_FALSE(loaded);
    CHECK(loaded.error().status == status::Bad_NotFound);
    CHECK(loaded.error().where.find(name) != std::string::npos);
    // Only a transfer of what is lost mends it.
    REQUIRE(later.transfer(machine_server(), MachineMode::Program));
    CHECK(!!later.load() == (name == std::string{"server.json"}));
    REQUIRE(later.transfer(machine_security(), MachineMode::Program));
    CHECK(later.load());
}

TEST_CASE_METHOD(SettingsWorld, "A file of settings of another version is an error (7-1-6)")
{
    REQUIRE(settings.transfer(machine_server(), MachineMode::Program));
    std::string document = read("server.json");
    document.replace(document.find("\"version\":1"), 11, "\"version\":2");
    write("server.json", document);
    const auto loaded = settings.load();
    REQUIRE_FALSE(loaded);
    CHECK(text(loaded.error()).find("version: found 2, expected 1") != std::string::npos);
}

TEST_CASE("Settings are the old or the new ones after a power cut (9-2-2, 35D00000)",
          "[power_cut][settings]")
{
    const bool is_new = GENERATE(true, false);
    bool is_done = false;
    std::size_t step = 0;
    for (; !is_done; ++step) {
        SettingsWorld world;
        ServerSettings before;
        if (!is_new) {
            before.port = 5'000;
            REQUIRE(world.settings.transfer(before, MachineMode::Program));
        }
        world.storage.cut_power_after(step);
        is_done = !!world.settings.transfer(machine_server(), MachineMode::Program);
        const ServerSettings in_force = world.settings.server();
        world.storage.restore_power();
        MachineSettings later = world.restarted();
        REQUIRE(later.load());
        if (later.server() != in_force || in_force != (is_done ? machine_server() : before)) {
            FAIL("half of it is done after " << step << " steps");
        }
    }
    CHECK(step > 100);
}

TEST_CASE("What was transferred stays, whatever fails in this transfer and the next (3-2-6)",
          "[power_cut][settings]")
{
    ServerSettings next;
    next.port = 6'000;
    bool is_first_undisturbed = false;
    const busbar::test::Turns faults{"transfers", 5};
    for (std::size_t first = faults.first; !is_first_undisturbed; first += faults.stride) {
        bool is_next_undisturbed = false;
        for (std::size_t second = 0; !is_next_undisturbed; second += 1 + second / 4) {
            SettingsWorld world;
            REQUIRE(world.settings.transfer(ServerSettings{}, MachineMode::Program));
            const std::size_t begin = world.storage.steps();
            world.storage.fail_once_after(first, StorageError::Away);
            static_cast<void>(world.settings.transfer(machine_server(), MachineMode::Program));
            is_first_undisturbed = world.storage.steps() - begin < first;
            world.storage.restore_power();
            const std::size_t middle = world.storage.steps();
            world.storage.fail_once_after(second, StorageError::Failed);
            static_cast<void>(world.settings.transfer(next, MachineMode::Program));
            is_next_undisturbed = world.storage.steps() - middle < second;
            world.storage.restore_power();
            MachineSettings later = world.restarted();
            REQUIRE(later.load());
            INFO("faults after " << first << " and " << second << " steps");
            REQUIRE(later.server() == world.settings.server());
        }
    }
}

TEST_CASE("A medium that is full, protected or away refuses a transfer whole (9-2-2, 35D00000)",
          "[power_cut][settings]")
{
    using Fault = std::function<void(storage::MemoryStorage&, bool)>;
    const std::map<std::string, Fault> faults{
        {"full", [](auto& storage, bool is_on) { storage.set_capacity(is_on ? 10 : UINT64_MAX); }},
        {"protected", [](auto& storage, bool is_on) { storage.set_protected(is_on); }},
        {"away", [](auto& storage, bool is_on) { storage.set_away(is_on); }},
    };
    for (const auto& [name, set] : faults) {
        for (const std::uint32_t port : {4'840U, 5'000U}) {
            INFO(name << " after " << port);
            SettingsWorld world;
            const ServerSettings before{.port = port}; // the first is that of a new controller
            REQUIRE((port == 4'840 || world.settings.transfer(before, MachineMode::Program)));
            set(world.storage, true);
            CHECK_FALSE(world.settings.transfer(machine_server(), MachineMode::Program));
            CHECK(world.settings.server() == before);
            set(world.storage, false);
            CHECK(world.settings.load());
            CHECK(world.settings.server() == before);
            CHECK(world.settings.transfer(machine_server(), MachineMode::Program));
            MachineSettings later = world.restarted();
            CHECK(later.load());
            CHECK(later.server() == machine_server());
        }
    }
}

} // namespace machine_settings_test
