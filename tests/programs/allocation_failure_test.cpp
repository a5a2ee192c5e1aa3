#include <catch2/catch.hpp>

#include <cstddef>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/project_store.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "machine_backup_fixture.hpp"
#include "product/access/reporting_owner.hpp"
#include "product/access/setup.hpp"
#include "product/machine/program_change.hpp"
#include "product/machine/program_service.hpp"
#include "product/model/project_service.hpp"
#include "product/store/received_program.hpp"
#include "product/store/taken_over.hpp"
#include "support/failing_worlds.hpp"

namespace allocation_failure_test {

// What an administrator changes of a controller with the k-th allocation failing, for k = 1, 2, ...
// until it goes through: it ends with an exception or is refused, everything is as it was, and the
// same succeeds at once.

using namespace busbar;
using namespace busbar::product;
using administration::SettingChange;
using busbar::test::check_failing_worlds;
using busbar::test::fail_and_repeat;

namespace {

/// A whole configuration takes thousands of allocations to read, most of them alike.
std::size_t next_of_many(std::size_t k)
{
    return k + 1 + k / 60;
}

std::span<const std::byte> bytes_of(const std::string& text)
{
    return std::as_bytes(std::span{text});
}

std::string content_of(const std::string& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

/// Without a problem of the work itself.
template <typename Work>
bool succeeds(Work work)
{
    try {
        return work();
    } catch (const ConfigError&) {
        return false;
    }
}

const std::string declarations = "VAR_GLOBAL\n  Speed_of_the_conveyor : INT;\nEND_VAR\n";

constexpr std::string_view configuration = R"(
[server]
name = "Press 4 of the second hall"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[users]
anonymous = "read"
[[plc.variable]]
name = "Temperature_of_the_oil"
type = "Double"
)";

} // namespace

TEST_CASE("an allocation that fails while a configuration is read ends that")
{
    const std::string text{configuration};
    check_failing_worlds(
        "parse_config",
        [&](std::size_t k) {
            return fail_and_repeat(k, [&] {
                return succeeds([&] { return parse_config(text, "press.toml").port != 0; });
            });
        },
        next_of_many);
}

TEST_CASE("an allocation that fails in a change of settings leaves all of them as they were")
{
    const test::TemporaryFolder folder;
    const std::string file = folder.path.string() + "/press.toml";
    const std::string kept = folder.path.string() + "/pki/settings.json";
    std::filesystem::create_directory(folder.path / "pki");
    std::ofstream{file} << "certificates.folder = \"" << folder.path.string() << "/pki\"\n"
                        << configuration;
    const std::vector<SettingChange> changes{
        {"limits.sessions", Variant{std::int64_t{8}}},
        {"server.name", Variant{"Press 5 of the second hall"}}};
    check_failing_worlds(
        "Settings",
        [&](std::size_t k) {
            std::filesystem::remove(kept);
            int applied = 0;
            Settings settings{file};
            settings.run({.check = [](const ControllerConfig&) { return Configured<void>{}; },
                          .apply = [&](const ControllerConfig&) { ++applied; }});
            const auto sessions = settings.config().server.limits.max_sessions;
            const bool has_failed = fail_and_repeat(
                k, [&] { return settings.list().change(changes, settings).has_value(); },
                [&] {
                    CHECK(settings.list().changes().empty());
                    CHECK(settings.config().server.limits.max_sessions == sessions);
                    CHECK(content_of(kept).empty());
                    CHECK(applied == 0);
                });
            CHECK(settings.list().changes().size() == 2);
            CHECK(settings.config().server.limits.max_sessions == 8);
            CHECK(settings.config().server.application_name == "Press 5 of the second hall");
            CHECK(applied == 1);
            return has_failed;
        },
        next_of_many);
}

TEST_CASE("an allocation that fails while the file is read again leaves what it said before")
{
    const test::TemporaryFolder folder;
    const std::string file = folder.path.string() + "/press.toml";
    const auto write = [&](const char* sessions) {
        std::ofstream{file} << "certificates.folder = \"" << folder.path.string() << "/pki\"\n"
                            << configuration << "[limits]\nsessions = " << sessions << "\n";
    };
    check_failing_worlds(
        "read_again",
        [&](std::size_t k) {
            write("7");
            Settings settings{file};
            write("8");
            const bool has_failed = fail_and_repeat(
                k,
                [&] {
                    return succeeds([&] {
                        settings.read_again([](const ControllerConfig&) {});
                        return true;
                    });
                },
                [&] { CHECK(settings.config().server.limits.max_sessions == 7); });
            CHECK(settings.config().server.limits.max_sessions == 8);
            return has_failed;
        },
        next_of_many);
}

TEST_CASE(
    "an allocation that fails while a controller keeps what it runs with leaves the one before")
{
    const auto of = [](const std::string& text) {
        TakenOver all;
        all.files.emplace("press.toml", std::make_shared<const std::string>(text));
        all.settings = "{}";
        all.project = std::make_shared<const std::string>(text);
        all.listeners = {{"", 4'840, ListenerUse::Data}};
        return all;
    };
    const TakenOver first = of("the first text of it");
    const TakenOver second = of("the second text of it");
    check_failing_worlds("TakenOverFiles", [&](std::size_t k) {
        storage::MemoryStorage storage;
        TakenOverFiles files{storage};
        REQUIRE(files.keep(first));
        const bool has_failed = fail_and_repeat(
            k, [&] { return files.keep(second).has_value(); },
            [&] {
                const auto all = TakenOverFiles{storage}.read();
                REQUIRE(all); // each part is of the first or of the second
                CHECK((all->project_text() == first.project_text() ||
                       all->project_text() == second.project_text()));
                CHECK(all->files.size() == 1);
            });
        CHECK(TakenOverFiles{storage}.read()->project_text() == second.project_text());
        return has_failed;
    });
}

TEST_CASE("an allocation that fails while a program is prepared or kept leaves the one before")
{
    const std::string first = document_of({.name = "press.st", .text = "of the first"});
    const std::string second = document_of({.name = "press.st", .text = declarations});
    check_failing_worlds("keep_received", [&](std::size_t k) {
        storage::MemoryStorage files;
        REQUIRE(keep_received(files, first));
        return fail_and_repeat(
            k, [&] { return keep_received(files, second).has_value(); },
            [&] {
                const auto kept = read_file(files, ReceivedProgram::file_name, 10'000);
                REQUIRE(kept);
                CHECK(std::string_view{reinterpret_cast<const char*>(kept->data()), kept->size()} ==
                      first);
            });
    });
    const ProgramBase base{
        {*controller::CheckedProgram::create({})}, PlcTrial{ControllerConfig{}}, true};
    check_failing_worlds("prepare_program", [&](std::size_t k) {
        return fail_and_repeat(
            k, [&] { return prepare_program(base, declarations, "press.st").has_value(); });
    });
}

namespace {

struct FixedClock final : WallClock {
    [[nodiscard]] DateTime now() const override { return DateTime{}; }
};

/// A controller with an empty program that a tool changes.
struct Programmed {
    [[nodiscard]] bool send(const char* wish)
    {
        const Variant options{wish};
        const administration::TransferRequest request{options, user, tool};
        const auto bytes = bytes_of(declarations);
        if (const auto prepare = service.preparation(request, bytes)) {
            prepare();
        }
        return service.take(request, bytes) == status::Good;
    }

    NodeId tool{1, "tool"};
    server::UserIdentity user;
    NullLog log;
    FixedClock clock;
    std::shared_ptr<const controller::CheckedProgram> program =
        controller::CheckedProgram::create({}).value();
    int changes{0};
    ProgramService service{
        {.program =
             [this] {
                 return ProgramInForce{.name = "a.st",
                                       .text = std::make_shared<const std::string>(),
                                       .program = program,
                                       .file = "a.st"};
             },
         .base =
             [this] {
                 return ProgramBase{{program}, PlcTrial{ControllerConfig{}}, true};
             },
         .change =
             [this](const ProgramChange&) {
                 const busbar::test::Uncounted by_the_test;
                 ++changes;
                 return Configured<ProgramVerdict>{};
             },
         .mode = [] { return controller::MachineMode::Program; },
         .set_mode = [](controller::MachineMode) { return Configured<void>{}; },
         .clock = clock,
         .log = log}};
};

} // namespace

TEST_CASE("an allocation that fails in a transfer of a program ends it")
{
    const char* const wish = GENERATE("check a.st", "compare a.st", "edit a.st", "download a.st");
    check_failing_worlds(wish, [&](std::size_t k) {
        Programmed controller;
        const bool is_check = std::string_view{wish}.starts_with("check");
        const bool has_failed = fail_and_repeat(
            k, [&] { return controller.send(wish); },
            [&] { CHECK((is_check || controller.changes == 0)); });
        CHECK((is_check || controller.changes <= 1));
        return has_failed;
    });
}

namespace {

/// Gets the records of changes, for which it takes no memory.
struct ChangeLog final : LogSink {
    void write(LogLevel, std::string_view, std::string_view) override {}
    [[nodiscard]] bool wants(RecordKind) const override { return true; }
    void record(const Record& record) override
    {
        ++records;
        has_method = field(record, "MethodId") != nullptr;
    }

    int records{0};
    bool has_method{false};
};

/// Tells what others have changed.
struct TellingOwner final : ReportingOwner {
    explicit TellingOwner(LogSink& log) : ReportingOwner{"test", log} {}
    using ReportingOwner::tell_changed;
};

} // namespace

TEST_CASE("a change is told to the log without memory, as that of a Method if it is one")
{
    const Variant options{"restore"};
    const server::UserIdentity user;
    const NodeId tool{1, "tool"};
    const NodeId method{0, "CloseAndCommit"};
    const bool has_method = GENERATE(false, true);
    ChangeLog log;
    const TellingOwner owner{log};
    busbar::test::fail_allocation(1, 1'000);
    CHECK(busbar::test::survives_counted([&] {
        owner.tell_changed({options, user, tool, has_method ? &method : nullptr},
                           RecordKind::TrustListUpdated);
    }));
    busbar::test::fail_allocation(0);
    CHECK(log.records == 1);
    CHECK(log.has_method == has_method);
}

TEST_CASE("an allocation that fails in a transfer of a project leaves the one before")
{
    const auto document_of_host = [](const std::string& host) {
        controller::Project project;
        project.network.host_name = host;
        return *controller::document_of(project);
    };
    const std::string first = document_of_host("FIRST");
    const std::string second = document_of_host("SECOND");
    const char* const wish = GENERATE("write", "verify", "update");
    const bool writes = std::string_view{wish} == "write";
    const bool updates = std::string_view{wish} == "update";
    NullLog log;
    const server::UserIdentity user;
    const NodeId tool{1, "tool"};
    check_failing_worlds(wish, [&](std::size_t k) {
        storage::MemoryStorage storage;
        controller::ProjectStore store{storage, "project", {}};
        REQUIRE(store.replace(bytes_of(first)));
        ProjectService service{
            {.store = store,
             .log = log,
             .status =
                 [] {
                     return ProjectService::ModuleStatus{"model mode", "Running", "1.2.3"};
                 },
             .update = [] { return Configured<void>{}; }}};
        const bool has_failed = fail_and_repeat(
            k,
            [&] {
                const Variant options{wish};
                const administration::TransferRequest request{options, user, tool};
                const auto bytes = updates ? std::span<const std::byte>{} : bytes_of(second);
                if (const auto prepare = service.preparation(request, bytes)) {
                    prepare();
                }
                return service.take(request, bytes) == status::Good;
            },
            [&] { CHECK(store.current()->network.host_name == "FIRST"); });
        CHECK(store.current()->network.host_name == (writes ? "SECOND" : "FIRST"));
        return has_failed;
    });
}

TEST_CASE("an allocation that fails in a backup or a restore of a machine leaves its files")
{
    const bool restores = GENERATE(false, true);
    busbar::test::BackupFixture first;
    const auto backup = first.made();
    check_failing_worlds(
        restores ? "restore of a machine" : "backup of a machine",
        [&](std::size_t k) {
            busbar::test::BackupFixture second;
            second.change();
            const auto there = second.there();
            const bool has_failed = fail_and_repeat(
                k,
                [&] {
                    return restores ? second.take("restore", backup) == "Good"
                                    : second.generate(Variant{}).has_value();
                },
                [&] {
                    CHECK(second.there() == there);
                    CHECK(second.restarts == 0);
                });
            CHECK((second.there() == there) != restores);
            CHECK(second.restarts == (restores ? 1 : 0));
            return has_failed;
        },
        next_of_many);
}

} // namespace allocation_failure_test
