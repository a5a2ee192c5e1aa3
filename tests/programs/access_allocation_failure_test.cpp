#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/project_store.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "product/access/administered.hpp"
#include "product/access/setup.hpp"
#include "product/configuration/live_config.hpp"
#include "product/model/kept_project.hpp"
#include "support/failing_worlds.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"
#include "support/temporary_folder.hpp"

namespace access_allocation_failure_test {

// Who is let in and what administers a controller, with the k-th allocation failing: in the setup,
// when accounts are read again, when a server is connected to its administration, and when a
// project is taken up.

using namespace busbar;
using namespace busbar::product;
using busbar::test::check_failing_worlds;
using busbar::test::fail_and_repeat;

namespace {

/// Reading and connecting take thousands of allocations, most of them alike.
std::size_t next_of_many(std::size_t k)
{
    return k + 1 + k / 60;
}

constexpr crypto::PasswordCost cheap{.scheme = crypto::PasswordScheme::Pbkdf2,
                                     .iterations = 10'000};
const DateTime today = DateTime::from_unix_seconds(1'750'000'000);

struct FixedClock final : WallClock {
    [[nodiscard]] DateTime now() const override { return today; }
};

struct NoWorker final : server::Worker {
    [[nodiscard]] bool run(std::function<void()>) override { return false; }
};

/// Without a problem of the work itself.
template <typename Work>
bool succeeds(Work work)
{
    try {
        return work();
    } catch (const ConfigError& error) {
        UNSCOPED_INFO(error.what());
        return false;
    }
}

const std::string& hash_of(const std::string& password)
{
    static std::map<std::string, std::string> hashes;
    std::string& hash = hashes[password];
    if (hash.empty()) {
        test::SeededRandom random{1};
        hash = crypto::hash_password(password, random, cheap).value();
    }
    return hash;
}

std::string account(const std::string& name, const std::string& password)
{
    return "[[users.account]]\nname = \"" + name + "\"\npassword = \"" + hash_of(password) + "\"\n";
}

} // namespace

TEST_CASE("an allocation that fails at the beginning of a setup leaves no code that nobody knows")
{
    check_failing_worlds("Setup::begin", [](std::size_t k) {
        storage::MemoryStorage files;
        crypto::InsecureAcceptAnyCertificate inner;
        server::PasswordUsers users;
        test::SeededRandom random{1};
        Setup setup{files, inner, users};
        std::optional<crypto::Secret> code;
        const bool has_failed = fail_and_repeat(
            k,
            [&] {
                return succeeds([&] {
                    code = setup.begin(random, cheap);
                    return setup.is_active();
                });
            },
            [&] {
                CHECK_FALSE(files.entry(Setup::code_file));
                CHECK_FALSE(setup.is_active());
                CHECK_FALSE(users.has_code(Setup::user_name));
            });
        REQUIRE(code);
        CHECK(users.log_in(Setup::user_name, code->text()));
        return has_failed;
    });
}

TEST_CASE("an allocation that fails at the end of a setup lets nobody in with its code")
{
    check_failing_worlds("Setup::end", [](std::size_t k) {
        storage::MemoryStorage files;
        crypto::InsecureAcceptAnyCertificate inner;
        server::PasswordUsers users;
        test::SeededRandom random{1};
        Setup setup{files, inner, users};
        REQUIRE(setup.begin(random, cheap));
        const bool has_failed = fail_and_repeat(k, [&] {
            setup.end();
            return true;
        });
        CHECK_FALSE(users.has_code(Setup::user_name));
        CHECK_FALSE(setup.is_active());
        CHECK_FALSE(files.entry(Setup::code_file));
        return has_failed;
    });
}

namespace {

/// A configuration on the disk, and who is let in by it.
struct Site {
    explicit Site(std::string first) { write(std::move(first)); }

    void write(std::string_view text) const
    {
        std::ofstream{file} << "certificates.folder = \"" << folder.path.string() << "/pki\"\n"
                            << text;
    }
    void remove_lists() const { std::filesystem::remove_all(folder.path / "pki"); }

    test::TemporaryFolder folder;
    std::string file{folder.path.string() + "/press.toml"};
};

} // namespace

TEST_CASE("an allocation that fails while accounts are read again changes none of them")
{
    const std::string first = "[users]\nanonymous = \"read\"\n" +
                              account("anna", "first password") +
                              account("cora", "second password");
    const std::string second = "[users]\nanonymous = \"read\"\n" +
                               account("bert", "third password") +
                               account("cora", "fourth password") + "[limits]\nsessions = 8\n";
    const Site site{first};
    NullLog log;
    check_failing_worlds(
        "reload",
        [&](std::size_t k) {
            site.write(first);
            Settings settings{site.file};
            Admission admission{settings.config(), settings.files(), log};
            const auto hash = [&](const char* name) {
                return admission.passwords().password_hash(name);
            };
            const auto anna = hash("anna");
            const auto cora = hash("cora");
            REQUIRE(!anna.empty());
            site.write(second);
            const bool has_failed = fail_and_repeat(
                k,
                [&] {
                    return succeeds(
                        [&] { return !reload(site.file, settings, admission, today).empty(); });
                },
                [&] {
                    const bool is_new = settings.config().users.accounts.front().name == "bert";
                    CHECK((hash("anna") == anna) != is_new);
                    CHECK(hash("bert").empty() != is_new);
                    CHECK((hash("cora") == cora) != is_new);
                    CHECK((admission.user_config().accounts.front().name == "bert") == is_new);
                });
            CHECK(hash("anna").empty());
            CHECK_FALSE(hash("bert").empty());
            CHECK((!hash("cora").empty() && hash("cora") != cora));
            CHECK(settings.config().server.limits.max_sessions == 8);
            return has_failed;
        },
        next_of_many);
}

namespace {

/// What a controller makes at each start and restart: a server with its administration.
struct Administration {
    Administration(Settings& settings, LogSink& log)
        : config{config_of(settings)}, admission{config, settings.files(), log},
          administered{config, settings.files(), clock, log}
    {
        administered.add_users(admission, config);
        server.emplace(
            expect(server::Server::create(config.server, {.random = &random,
                                                          .wall_clock = &clock,
                                                          .log = &administered.log(),
                                                          .validator = &administered.clients(),
                                                          .users = &admission.users(),
                                                          .roles = &administered.roles(),
                                                          .waker = &waker})));
        administered.attach({.server = *server,
                             .admission = admission,
                             .config = config,
                             .settings = settings,
                             .worker = worker,
                             .stop = [] {},
                             .is_in_run = [] { return false; },
                             .offer_changed = [] {}});
    }
    static ControllerConfig config_of(const Settings& settings)
    {
        ControllerConfig config = settings.config();
        config.server.application_uri = "urn:busbar:test:server";
        config.server.endpoint_url = "opc.tcp://localhost:4840";
        config.server.identity = test::server_identity();
        return config;
    }

    struct Awake final : Waker {
        void wake() override {}
    };

    FixedClock clock;
    crypto::SystemRandom random;
    Awake waker;
    NoWorker worker;
    ControllerConfig config;
    Admission admission;
    Administered administered;
    std::optional<server::Server> server;
};

} // namespace

TEST_CASE("an allocation that fails while a server gets its administration leaves none of it")
{
    const bool has_setup = GENERATE(false, true);
    const Site site{"[server]\nauditing = true\n[[endpoint]]\npolicy = \"Basic256Sha256\"\n"
                    "mode = \"SignAndEncrypt\"\n[users]\n" +
                    std::string{has_setup ? "setup = true\n" : ""} +
                    (has_setup ? std::string{} : account("anna", "first password"))};
    NullLog log;
    check_failing_worlds(
        has_setup ? "Administered, with a setup" : "Administered",
        [&](std::size_t k) {
            site.remove_lists();
            Settings settings{site.file};
            std::optional<Administration> made;
            const bool has_failed = fail_and_repeat(
                k,
                [&] {
                    return succeeds([&] {
                        made.emplace(settings, log);
                        return true;
                    });
                },
                [&] {
                    made.reset();
                    CHECK_FALSE(settings.files().entry(Setup::code_file));
                });
            CHECK(made->administered.is_in_setup() == has_setup);
            CHECK(made->administered.new_code().has_value() == has_setup);
            return has_failed;
        },
        next_of_many);
}

TEST_CASE("an allocation that fails while a project is taken up leaves it as it was")
{
    controller::Project project;
    project.network.host_name = "FIRST";
    project.users.push_back({.name = "hmi", .password_hash = hash_of("a password")});
    const std::string document = *controller::document_of(project);
    const test::TemporaryFolder folder;
    const std::string file = folder.path.string() + "/project/project.busbar";
    std::filesystem::create_directory(folder.path / "project");
    std::ofstream{file, std::ios::binary} << document;
    NullLog log;
    FixedClock clock;
    crypto::SystemRandom random;
    const auto new_server = [&] {
        server::ServerConfig config;
        config.endpoints.clear();
        config.endpoints.emplace_back().allows_anonymous = true;
        return server::Server::create(config,
                                      {.random = &random, .wall_clock = &clock, .log = &log})
            .value();
    };
    check_failing_worlds(
        "KeptProject",
        [&](std::size_t k) {
            std::optional<server::Server> server{new_server()};
            ControllerConfig config;
            const bool has_failed = fail_and_repeat(
                k,
                [&] {
                    return succeeds([&] {
                        const KeptProject kept{folder.path.string()};
                        ControllerConfig next;
                        kept.apply(next, {});
                        static_cast<void>(kept.publish(*server, "1.2.3", log));
                        config = std::move(next);
                        return kept.project() != nullptr && kept.document() == document &&
                               kept.version().has_value();
                    });
                },
                [&] {
                    server.emplace(new_server()); // a failed start throws its server away
                    std::ifstream now{file, std::ios::binary};
                    CHECK(std::string{std::istreambuf_iterator<char>{now}, {}} == document);
                });
            CHECK(config.host_names == std::vector<std::string>{"FIRST"});
            return has_failed;
        },
        next_of_many);
}

} // namespace access_allocation_failure_test
