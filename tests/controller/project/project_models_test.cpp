#include <catch2/catch.hpp>

#include <span>
#include <string>

#include <busbar/controller/project_models.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "project_fixture.hpp"

namespace project_models_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

constexpr const char* press_uri = "http://press.example/press";

Project with_node(const std::string& node)
{
    Project project = test::press_project();
    project.models[1].text = test::model_text(press_uri, node);
    return project;
}

std::string speed(const std::string& data_type = "i=4")
{
    return "<UAVariable NodeId=\"ns=1;i=5\" BrowseName=\"1:Speed\" DataType=\"" + data_type +
           "\">\n<DisplayName>Speed</DisplayName>\n<References>\n"
           "<Reference ReferenceType=\"i=40\">i=63</Reference>\n"
           "<Reference ReferenceType=\"i=47\" IsForward=\"false\">i=85</Reference>\n"
           "</References>\n</UAVariable>\n";
}

} // namespace

TEST_CASE("9.3 Project: models are loaded, mapped and kept with their mapping", "[9.3]")
{
    Project project = with_node(speed());
    auto models = load_models(project);
    REQUIRE(models);
    CHECK(models->namespaces().size() == 3);
    const NodeId node{2, 5U};
    REQUIRE(models->space().find(node) != model::no_node);
    CHECK(models->mapping().variables.empty());

    models->mapping().variables[node].value.label = "Line.Speed";
    keep_models(*models, project);
    REQUIRE(project.models.size() == 2);
    CHECK(project.models[1].name == "Press.xml");
    CHECK(project.models[1].text.find("Line.Speed") != std::string::npos);

    const auto document = document_of(project);
    REQUIRE(document);
    const auto again = load_models(*read_project(*document, "again"));
    REQUIRE(again);
    CHECK(again->mapping().variables.at(node).value.label == "Line.Speed");
    // What was kept once is kept as it is: files of projects can be compared.
    Project once_more = project;
    keep_models(*again, once_more);
    CHECK(once_more == project);
}

TEST_CASE("9.13 Write: a model that no server could load changes nothing and is named", "[9.13]")
{
    storage::MemoryStorage storage;
    ProjectStore store{storage, "project", check_models};
    REQUIRE(store.recover());
    const auto replace = [&](const Project& project) {
        const std::string document = *document_of(project);
        const auto done = store.replace(std::as_bytes(std::span{document}));
        return done ? "none" : text(done.error());
    };
    REQUIRE(replace(with_node(speed())) == "none");
    const std::string before = *store.document();

    const std::string problem = replace(with_node(speed("ns=1;i=77")));
    INFO(problem);
    CHECK(problem.find("Press.xml:") != std::string::npos);
    CHECK(problem.find("ns=1;i=5") != std::string::npos);
    CHECK(replace(with_node("<UAVariable")).find("Press.xml") != std::string::npos);
    Project twice = with_node(speed());
    twice.models[0].text = "<UANodeSet/>";
    CHECK(replace(twice).find("Types.xml") != std::string::npos);
    CHECK(store.document().value() == before);
}

} // namespace project_models_test
