#include "product/configuration/reading.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.hpp"

namespace reading_test {

using namespace busbar;

// What a controller's file, its project and the command line say, and which of them counts.

namespace {

struct ProjectFolder {
    explicit ProjectFolder(const controller::Project& project)
    {
        std::filesystem::create_directory(folder.path / "project");
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

} // namespace reading_test
