#include "product/configuration/reading.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

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
                        << "\"\nmachine.program = \"" << program << "\"\n";
    const auto reading = product::read_sources({.file = file});
    const auto text = *reading.config.machine.program_text;
    declare("NOTHING");
    const administration::SettingChange sessions{"limits.sessions", Variant{std::int64_t{20}}};
    REQUIRE(reading.settings->list().change({&sessions, 1}, *reading.settings));
    CHECK(*reading.settings->config().machine.program_text == text);
    CHECK_THROWS_AS(product::read_sources({.file = file}), product::ConfigError);
    // With what the files had, it works.
    const auto again =
        product::read_sources({.file = file}, {.files = reading.settings->sources().texts()});
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

} // namespace reading_test
