#include "machine_backup_fixture.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "product/machine/machine_retained.hpp"
#include "product/store/received_program.hpp"

namespace whole_backup_test {

// A backup has what a controller needs that takes the place of another one, wherever it is from.

using namespace busbar;
using namespace busbar::product;
using namespace busbar::test;

namespace {

std::string declared(const std::string& variables)
{
    return "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n    " + variables + "\nEND_VAR\n";
}

/// A machine with a configuration's file and a program of its own.
struct Unit : BackupFixture {
    explicit Unit(const std::string& keys, const std::string& program = "a : INT;")
    {
        for (const std::string& name : files.names()) {
            REQUIRE(files.remove(name));
        }
        write("press.st", declared(program));
        write("unit.toml", "[certificates]\nfolder = \"" + path("pki") +
                               "\"\n[machine]\nprogram = \"" + path("press.st") + "\"\n" + keys);
        read_again();
    }
    [[nodiscard]] std::string path(const std::string& name) const
    {
        return folder.path.string() + "/" + name;
    }
    void write(const std::string& name, const std::string& text) const
    {
        std::ofstream{path(name)} << text;
    }
    /// As the next start does.
    void read_again()
    {
        const auto put_in_folder = [&](const char* name) {
            const auto bytes = read_file(files, name, 1'000'000);
            std::filesystem::create_directories(path("pki"));
            std::filesystem::remove(path("pki/") + name);
            if (bytes) {
                std::ofstream{path("pki/") + name}.write(
                    reinterpret_cast<const char*>(bytes->data()),
                    static_cast<std::streamsize>(bytes->size()));
            }
        };
        put_in_folder(Settings::file_name);
        put_in_folder(std::string{ReceivedProgram::file_name}.c_str());
        backup.reset();
        settings = std::make_unique<Settings>(path("unit.toml"));
        REQUIRE(take_up_values(files, state));
        start();
    }
    [[nodiscard]] Bytes whole()
    {
        auto bytes = generate(Variant{});
        REQUIRE(bytes);
        return *std::move(bytes);
    }
    [[nodiscard]] const ControllerConfig& config() const { return settings->config(); }
    [[nodiscard]] std::string values()
    {
        const auto bytes = read_file(state, "retained", 1'000);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : "none";
    }
    void put_values(const std::string& name, const std::string& text)
    {
        REQUIRE(state.replace(name, bytes_of(text), FileAccess::Owner));
    }
};

constexpr const char* keys_of_first = "name = \"Press 4\"\nuse = false\nmode = \"PROGRAM\"\n"
                                      "execution_log_records = 100\n[server]\nport = 4841\n"
                                      "name = \"First\"\naddress = \"127.0.0.2\"\n"
                                      "[limits]\nsessions = 7\n[users]\nanonymous = \"read\"\n"
                                      "[[plc.program]]\nkind = \"increment\"\ntarget = \"a\"\n";

} // namespace

TEST_CASE("whole backup: another unit has settings and program of the file (8-2-1, 8-2-4)")
{
    Unit first{keys_of_first};
    first.put_values("retained", "values of the first");
    const Bytes file = first.whole();
    Unit second{"execution_log_files = 5\n", "b : REAL;"};
    second.put_values("retained", "values of the second");
    second.put_values("retained.journal-1", "written since");
    CHECK(second.take("verify", file) == "Good");
    CHECK(second.report().find(R"("Server settings","differences":["settings.json"])") !=
          std::string::npos);
    CHECK(second.report().find(R"("Program","differences":["program.received"])") !=
          std::string::npos);
    CHECK(second.report().find("Retained") == std::string::npos);
    CHECK(second.take("restore", file) == "Good");
    INFO(second.report());
    CHECK(second.values() == "values of the second"); // the program still runs
    second.read_again();
    CHECK(second.values() == "values of the first");
    CHECK(second.state.names() == std::vector<std::string>{"retained"});
    const ControllerConfig& config = second.config();
    CHECK(config.machine.name == "Press 4");
    CHECK_FALSE(config.machine.is_used);
    CHECK(config.machine.mode == controller::MachineMode::Program);
    CHECK(config.machine.execution_log.records == 100);
    CHECK(config.machine.execution_log.files == 24); // not what the other file says
    CHECK(config.port == 4'841);
    CHECK(config.server.application_name == "First");
    CHECK(config.server.limits.max_sessions == 7);
    CHECK(config.users.anonymous == AccountAccess::Read);
    CHECK(config.machine.program->program().variables.front().name == "a");
    CHECK(config.address != "127.0.0.2"); // of the first machine's network
    CHECK(second.take("verify", file) == "Good");
    CHECK(second.report().find("settings.json\"]") == std::string::npos);
    CHECK(second.report().find("program.received\"]") == std::string::npos);
}

TEST_CASE("whole backup: the same unit has its files again, and no more said over them")
{
    Unit unit{keys_of_first};
    const Bytes file = unit.whole();
    unit.put("settings.json", R"({"version":1,"settings":{"server.name":"Changed"}})");
    unit.put("program.received", document_of({.name = "other.st", .text = declared("a : INT;")}));
    unit.read_again();
    CHECK(unit.config().server.application_name == "Changed");
    CHECK(unit.config().machine.program_name == "other.st");
    CHECK(unit.take("restore", file) == "Good");
    CHECK(unit.files.names().empty());
    unit.read_again();
    CHECK(unit.config().server.application_name == "First");
    CHECK(unit.config().machine.program_name == unit.path("press.st"));
}

TEST_CASE("whole backup: a program that was sent is in it, whoever sent it")
{
    Unit first{""};
    const std::string text = declared("sent : INT;");
    first.put("program.received", document_of({.name = "sent.st", .user = "pat", .text = text}));
    first.read_again();
    const Bytes file = first.whole();
    CHECK(first.take("verify", file) == "Good");
    CHECK(first.report().find("program.received\"]") == std::string::npos);
    Unit second{""};
    CHECK(second.take("restore", file) == "Good");
    second.read_again();
    CHECK(second.config().machine.program_name == "sent.st");
    CHECK(*second.config().machine.program_text == text);
}

TEST_CASE("whole backup: settings that do not fit the program change nothing")
{
    Unit first{"[[plc.program]]\nkind = \"increment\"\ntarget = \"gone\"\n", "gone : INT;"};
    const Bytes file = first.whole();
    Unit second{""};
    second.put("settings.json", R"({"version":1,"settings":{"server.name":"Second"}})");
    second.read_again();
    const Files before_it = second.there();
    // Without its program, as an earlier version made it.
    Bytes settings_only = [&] {
        controller::MemoryItem item{.name = "Server settings", .files = {"settings.json"}};
        storage::MemoryStorage memory;
        const std::string document = administration::settings_document(
            {{"plc.program", first.settings->all_values({}).at("plc.program")}});
        REQUIRE(
            memory.replace("settings.json", BackupFixture::bytes_of(document), FileAccess::Owner));
        return controller::MachineMemory{memory, "transaction", {item}, first.log}
            .backup({"Press"})
            .value();
    }();
    CHECK(second.take("restore", settings_only) == "Bad_ConfigurationError");
    CHECK(second.report().find("gone") != std::string::npos);
    CHECK(second.there() == before_it);
    const std::string restored = second.take("restore", file);
    INFO(second.report());
    CHECK(restored == "Good");
}

TEST_CASE("whole backup: a backup of an earlier version has what was changed online alone")
{
    Unit unit{keys_of_first};
    unit.put_values("retained", "kept");
    const Bytes old = unit.with_settings(R"({"version":1,"settings":{"limits.sessions":9}})");
    unit.put("settings.json", R"({"version":1,"settings":{"server.name":"Since"}})");
    unit.read_again();
    CHECK(unit.take("restore", old) == "Good");
    CHECK(unit.there()["settings.json"] ==
          "{\"version\":1,\"settings\":{\"limits.sessions\":9}}\n");
    unit.read_again();
    CHECK(unit.config().server.application_name == "First");
    CHECK(unit.values() == "kept");
}

TEST_CASE("whole backup: Clear All Memory forgets values and a program that was sent (8-3)")
{
    Unit unit{keys_of_first};
    unit.mode = controller::MachineMode::Program;
    unit.put_values("retained", "values");
    unit.put("program.received", document_of({.name = "sent.st", .text = declared("a : INT;")}));
    unit.read_again();
    CHECK(unit.take("clear", {}) == "Good");
    unit.read_again();
    CHECK(unit.values() == "none");
    CHECK(unit.config().machine.program_name == unit.path("press.st"));
}

TEST_CASE("whole backup: values come to their place whenever the power goes")
{
    storage::MemoryStorage files;
    storage::MemoryStorage state;
    const auto put = [](Storage& storage, std::string_view name, std::string_view text) {
        REQUIRE(storage.replace(name, BackupFixture::bytes_of(text), FileAccess::Owner));
    };
    bool was_cut = true;
    for (std::size_t cuts = 0; was_cut; ++cuts) {
        REQUIRE(cuts < 100);
        put(files, restored_values_name, "restored");
        put(state, "retained", "before");
        put(state, "retained.journal-1", "before");
        const std::size_t begin = state.steps();
        state.cut_power_after(cuts);
        static_cast<void>(take_up_values(files, state));
        was_cut = state.steps() - begin >= cuts;
        state.restore_power();
        REQUIRE(take_up_values(files, state));
        CHECK(state.names() == std::vector<std::string>{"retained"});
        const auto bytes = read_file(state, "retained", 1'000);
        REQUIRE(bytes);
        CHECK(std::ranges::equal(*bytes, BackupFixture::bytes_of("restored")));
        CHECK(files.names().empty());
    }
}

TEST_CASE("whole backup: a first start has no folder yet, and no values to restore")
{
    const TemporaryFolder folder;
    storage::FolderStorage files{(folder.path / "pki").string()};
    storage::MemoryStorage state;
    CHECK(take_up_values(files, state));
}

} // namespace whole_backup_test
