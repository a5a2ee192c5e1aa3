#include "product/configuration/reading.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "product/configuration/limit_keys.hpp"
#include "product/printing/describe.hpp"
#include "support/temporary_folder.hpp"

namespace reading_test {

using namespace busbar;

// What a controller's file, its project and the command line say, and which of them counts.

namespace {

struct ProjectFolder {
    explicit ProjectFolder(const controller::Project& project)
    {
        std::filesystem::create_directory(folder.path / "project");
        std::filesystem::create_directory(folder.path / "certificates");
        std::ofstream{folder.path / "project" / "project.busbar", std::ios::binary}
            << *controller::document_of(project);
        std::ofstream{folder.path / "file.toml"}
            << "certificates.folder = \"" << (folder.path / "certificates").string() << "\"\n";
    }

    [[nodiscard]] product::ControllerConfig read(const std::string& preset = {}) const
    {
        return product::read_sources({.file = (folder.path / "file.toml").string(),
                                      .port = {},
                                      .preset = preset,
                                      .project = folder.path.string()})
            .config;
    }

    [[nodiscard]] product::Reading sources(std::optional<std::uint16_t> port = {},
                                           product::Substitutes substitutes = {}) const
    {
        return product::read_sources({.file = (folder.path / "file.toml").string(),
                                      .port = port,
                                      .preset = {},
                                      .project = folder.path.string()},
                                     std::move(substitutes));
    }

    test::TemporaryFolder folder;
};

} // namespace

TEST_CASE("9.3 reading: a project of a product has the product's limits", "[9.3]")
{
    controller::Project project;
    CHECK(ProjectFolder{project}.read().server.limits.max_sessions ==
          server::ServerLimits{}.max_sessions);
    project.preset = "rd81opc96";
    const ProjectFolder module{project};
    CHECK(module.read().server.limits.max_sessions == 15);
    CHECK(module.read("nj501").server.limits.max_sessions != 15);
}

TEST_CASE("9.10 reading: what a project says of the certificate", "[9.10]")
{
    controller::Project project;
    project.certificate = {.server_name = "PRESS",
                           .organization = "Works",
                           .unit = "Line 4",
                           .locality = "",
                           .state = "",
                           .country = "DE"};
    const product::SubjectNames subject = ProjectFolder{project}.read().certificates.subject;
    const auto names = product::subject_of(subject, "name", {"press-4"});
    CHECK(names.common_name == "PRESS");
    CHECK(names.organization == "Works");
    CHECK(names.organizational_unit == "Line 4");
    CHECK(names.country == "DE");
}

TEST_CASE(
    "reading: the project counts more than the file, and what was changed online more than it",
    "[9.3]")
{
    controller::Project project;
    project.network.listeners[0].port = 4'850;
    project.discovery.url = "opc.tcp://discovery:4840";
    project.security.policies = {"Aes256_Sha256_RsaPss"};
    project.security.allows_anonymous = true;
    const ProjectFolder module{project};
    std::ofstream{module.folder.path / "file.toml", std::ios::app}
        << "[server]\nport = 4841\n[discovery]\nurl = \"opc.tcp://other:4840\"\n";
    const auto reading = module.sources();
    product::Settings& settings = *reading.settings;
    const auto policy = [&] {
        return settings.config().server.endpoints.at(0).security.policy->name;
    };
    CHECK(settings.config().port == 4'850);
    CHECK(policy() == "Aes256_Sha256_RsaPss");

    // A change, and the file again, leave what the project says.
    const administration::SettingChange sessions{"limits.sessions", Variant{std::int64_t{20}}};
    REQUIRE(settings.list().change({&sessions, 1}, settings));
    settings.read_again([](const auto&) {});
    CHECK(settings.config().server.limits.max_sessions == 20);
    CHECK(settings.config().port == 4'850);
    CHECK(settings.config().discovery.url == "opc.tcp://discovery:4840");
    CHECK(settings.config().users.anonymous == product::AccountAccess::Write);
    CHECK(policy() == "Aes256_Sha256_RsaPss");

    const administration::SettingChange url{"discovery.url", Variant{"opc.tcp://third:4840"}};
    REQUIRE(settings.list().change({&url, 1}, settings));
    CHECK(settings.config().discovery.url == "opc.tcp://third:4840");
    CHECK(settings.value(*settings.list().find("discovery.url")) == url.value);
    CHECK(settings.value(*settings.list().find("server.port")) == Variant{std::int64_t{4'850}});
    CHECK(module.sources(4'900).config.port == 4'900);
}

TEST_CASE("reading: a change of a setting takes over no file that is another one by now")
{
    const test::TemporaryFolder folder;
    const std::string file = (folder.path / "file.toml").string();
    const std::string program = (folder.path / "press.st").string();
    const auto declare = [&](const std::string& type) {
        std::ofstream{program} << "VAR_GLOBAL Speed : " << type << "; END_VAR\n";
    };
    declare("INT");
    std::filesystem::create_directory(folder.path / "pki");
    std::ofstream{file} << "certificates.folder = \"" << (folder.path / "pki").string()
                        << "\"\nmachine.program = \"" << program << "\"\nmachine.strict = true\n";
    const auto reading = product::read_sources({.file = file});
    const auto text = *reading.config.machine.program_text;
    declare("NOTHING");
    const administration::SettingChange sessions{"limits.sessions", Variant{std::int64_t{20}}};
    REQUIRE(reading.settings->list().change({&sessions, 1}, *reading.settings));
    CHECK(*reading.settings->config().machine.program_text == text);
    CHECK_THROWS_AS(product::read_sources({.file = file}), product::ConfigError);
    // With what the files had, it works.
    const auto again =
        product::read_sources({.file = file}, {.files = reading.settings->sources()});
    CHECK(*again.config.machine.program_text == text);
    CHECK(again.config.server.limits.max_sessions == 20);
}

TEST_CASE("reading: another project is served where the one that is there cannot be read", "[9.13]")
{
    controller::Project project;
    project.network.host_name = "PRESS";
    const std::string document = *controller::document_of(project);
    ProjectFolder module{controller::Project{}};
    CHECK(module.sources({}, {.project = document}).project->project()->network.host_name.empty());
    CHECK(module.sources({}, {.project = document, .takes_other_project = true})
              .project->project()
              ->network.host_name == "PRESS");
    std::ofstream{module.folder.path / "project" / "project.busbar"} << "busbar project 1\n";
    CHECK(module.sources().project->project() == nullptr);
    const auto served = module.sources({}, {.project = document}).project;
    REQUIRE(served->project() != nullptr);
    CHECK(served->project()->network.host_name == "PRESS");
    CHECK(served->document() == document);
}

TEST_CASE("reading: the command line counts more than what was changed online")
{
    const ProjectFolder module{controller::Project{}};
    {
        const auto reading = module.sources();
        const administration::SettingChange preset{"limits.preset", Variant{"rd81opc96"}};
        REQUIRE(reading.settings->list().change({&preset, 1}, *reading.settings));
        CHECK(reading.settings->config().server.limits.max_sessions == 15);
    }
    CHECK(module.read().server.limits.max_sessions == 15);
    CHECK(module.read("nj501").server.limits.max_sessions == 5);
}

namespace {

/// "file.toml:3 7" for each layer that says something of the setting, the built-in one first.
std::vector<std::string> sayings(const product::Provenance& provenance, const std::string& name)
{
    const auto settings = provenance.settings();
    const auto setting = std::ranges::find(settings, name, &administration::Setting::name);
    REQUIRE(setting != settings.end());
    std::vector<std::string> all;
    for (const product::Saying& saying : provenance.sayings(*setting)) {
        const auto* const number = saying.value.get_if<std::int64_t>();
        const auto* const text = saying.value.get_if<String>();
        const std::size_t folder = saying.where.rfind('/');
        all.push_back(std::to_string(static_cast<int>(saying.layer)) + " " +
                      saying.where.substr(folder == std::string::npos ? 0 : folder + 1) + " " +
                      (number != nullptr ? std::to_string(*number)
                       : text != nullptr ? text->str()
                                         : "?"));
    }
    return all;
}

} // namespace

TEST_CASE("reading: each value says which layers say it, and what it would be without them")
{
    using Said = std::vector<std::string>;
    controller::Project project;
    project.network.listeners[0].port = 4'850;
    project.preset = "rd81opc96";
    const ProjectFolder module{project};
    std::ofstream{module.folder.path / "file.toml", std::ios::app}
        << "[server]\nport = 4841\n[limits]\nsessions = 7\nmessage_size = 33554432\n";
    {
        const auto reading = module.sources();
        const administration::SettingChange changes[] = {
            {"limits.sessions", Variant{std::int64_t{20}}},
            {"server.port", Variant{std::int64_t{4'860}}}};
        REQUIRE(reading.settings->list().change(changes, *reading.settings));
    }
    const product::Provenance all =
        product::provenance_of({.file = (module.folder.path / "file.toml").string(),
                                .port = 4'900,
                                .preset = "nj501",
                                .project = module.folder.path.string()});
    CHECK(sayings(all, "limits.sessions") ==
          Said{"0  100", "1 nj501 5", "2 file.toml:5 7", "4  20"});
    CHECK(sayings(all, "server.port") ==
          Said{"0  4840", "2 file.toml:3 4841", "3  4850", "4  4860", "5 --port 4900"});
    CHECK(sayings(all, "limits.preset") == Said{"0  ", "3  rd81opc96", "5 --preset nj501"});
    CHECK(sayings(all, "limits.sessions_per_user") == Said{"0  60", "1 nj501 5"});
    // Follows of the size of a message.
    CHECK(sayings(all, "limits.assembly") == Said{"0  67108864", "2  134217728"});
    CHECK(sayings(all, "limits.depth") ==
          Said{"0  " + std::to_string(binary::DecodeLimits{}.max_depth)});
    CHECK(all.config().port == 4'900);
}

TEST_CASE("reading: what is in force is what the last layer says, of every setting")
{
    controller::Project project;
    project.security.allows_anonymous = true;
    project.certificate.organization = "Works";
    const ProjectFolder module{project};
    std::ofstream{module.folder.path / "file.toml", std::ios::app}
        << "[limits]\nmemory = \"64 MB\"\n[users]\npassword_hash = \"pbkdf2\"\n";
    const auto reading = module.sources();
    const product::Provenance all =
        product::provenance_of({.file = (module.folder.path / "file.toml").string(),
                                .port = {},
                                .preset = {},
                                .project = module.folder.path.string()});
    for (const administration::Setting& setting : all.settings()) {
        INFO(setting.name);
        const auto said = all.sayings(setting);
        CHECK(said.back().value == reading.settings->value(setting));
        CHECK(said.front().layer == product::Layer::BuiltIn);
    }
    CHECK(sayings(all, "users.anonymous") == std::vector<std::string>{"0  no", "3  write"});
    CHECK(sayings(all, "limits.sessions").back().starts_with("1 limits.memory "));
}

TEST_CASE("explain: a key with all that counts of it")
{
    const ProjectFolder module{controller::Project{}};
    std::ofstream{module.folder.path / "file.toml", std::ios::app}
        << "[limits]\nsend_timeout_ms = 7000\n";
    const std::string file = (module.folder.path / "file.toml").string();
    const product::Provenance all =
        product::provenance_of({.file = file, .port = {}, .preset = {}, .project = {}});
    CHECK(product::explain(all, "limits.send_timeout_ms") == "limits.send_timeout_ms = 7000 ms\n"
                                                             "  from        file " +
                                                                 file +
                                                                 ":3\n"
                                                                 "  otherwise   30000, built-in\n"
                                                                 "  default     30000\n"
                                                                 "  least       100\n"
                                                                 "  most        86400000\n"
                                                                 "  a change    counts at once\n");
    CHECK(product::explain(all, "certificates.folder").find("file " + file + ":1\n") !=
          std::string::npos);
    CHECK(product::explain(all, "limits.nonsense").empty());
    CHECK(product::keys_like(all, "limits.sesions").front() == "limits.sessions");
    CHECK(product::keys_like(all, "port") == std::vector<std::string>{"server.port"});
    // A line for each: no key of the table of limits is left out.
    const std::string lines = product::explain(all, "all");
    for (const product::LimitKey& key : product::limit_keys()) {
        const std::string name = product::setting_name(key);
        INFO(name);
        CHECK(("\n" + lines).find("\n" + name + " = ") != std::string::npos);
        CHECK_FALSE(product::explain(all, name).empty());
    }
}

} // namespace reading_test
