#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <busbar/controller/project_compare.hpp>

#include "project_fixture.hpp"

namespace project_compare_test {

using namespace busbar;
using namespace busbar::controller;
using Differences = std::vector<ProjectDifference>;

TEST_CASE("9.13 Verify: settings that differ are listed one by one", "[9.13]")
{
    const Project first = test::press_project();
    CHECK(setting_differences(first, first).empty());

    Project second = first;
    second.network.host_name = "PRESS5";
    second.network.listeners.pop_back();
    second.security.allows_anonymous = true;
    second.sampling = ProjectSampling::Standard;
    CHECK(setting_differences(first, second) ==
          Differences{{"listener 2.address", "\"10.1.0.7\"", "nothing"},
                      {"listener 2.mask", "\"255.255.0.0\"", "nothing"},
                      {"listener 2.port", "\"4841\"", "nothing"},
                      {"listener 2.use", "\"administration\"", "nothing"},
                      {"network.host_name", "\"PRESS4\"", "\"PRESS5\""},
                      {"sampling.mode", "\"high-speed items\"", "\"standard\""},
                      {"security.allow_anonymous", "\"no\"", "\"yes\""}});
}

TEST_CASE("9.13 Verify: users are compared by name, and no hash is shown", "[9.13]")
{
    const Project first = test::press_project();
    Project second = first;
    std::swap(second.users[0], second.users[1]);
    CHECK(setting_differences(first, second).empty());
    second.users[0].permission = ProjectPermission::Tool;
    second.users[1].password_hash[20] = 'B';
    CHECK(setting_differences(first, second) ==
          Differences{{"user engineer: password_hash", "another password", "another password"},
                      {"user hmi: permission", "\"client\"", "\"tool\""}});
    second.users.erase(second.users.begin());
    CHECK(setting_differences(first, second)[1] ==
          ProjectDifference{"user hmi: name", "\"hmi\"", "nothing"});
}

TEST_CASE("9.13 Verify: nodes and mapping that differ are listed one by one", "[9.13]")
{
    const auto variable = [](const std::string& id, const std::string& name,
                             const std::string& label) {
        return "<UAVariable NodeId=\"" + id + "\" BrowseName=\"1:" + name + "\"><DisplayName>" +
               name + "</DisplayName>" +
               (label.empty() ? ""
                              : "<Extensions><Extension>" + label + "</Extension></Extensions>") +
               "</UAVariable>\n";
    };
    const auto project = [&](const std::string& nodes) {
        Project made = test::press_project();
        made.models[1].text = test::model_text("http://press.example/press", nodes);
        return made;
    };
    const Project first =
        project(variable("ns=1;i=1", "Speed", "a") +
                variable("ns=1;i=2", "Force", "<DataMapping Data=\"Line.Force\"/>") +
                variable("ns=1;i=3", "Stroke", ""));
    CHECK(model_differences(first, first).empty());
    // Blanks between elements, the order of nodes and the file's name do not matter.
    Project same =
        project(variable("ns=1;i=3", "Stroke", "") + variable("ns=1;i=1", "Speed", "a") + "\n\n" +
                variable("ns=1;i=2", "Force", "<DataMapping Data=\"Line.Force\"/>"));
    same.models[1].name = "Other.xml";
    CHECK(model_differences(first, same).empty());

    // Labels are told part by part.
    const std::string parts = "<DataMapping IsArray=\"true\" IsStructure=\"true\">"
                              "<Element Num=\"1\"><Field Name=\"Max\" Data=\"Line.Max\"/></Element>"
                              "</DataMapping><MethodMapping><Handle Data=\"H\"/><Input>"
                              "<Argument Num=\"0\" Data=\"A\"/></Input></MethodMapping>";
    Project second =
        project(variable("ns=1;i=1", "Speeds", "a") + variable("ns=1;i=2", "Force", parts) +
                variable("ns=1;i=4", "Stroke", ""));
    const std::string uri = "http://press.example/press: ";
    CHECK(model_differences(first, second) ==
          Differences{{uri + "ns=1;i=1", "another node", "another node"},
                      {uri + "ns=1;i=2", "Line.Force", "no label"},
                      {uri + "ns=1;i=2: Handle", "no label", "H"},
                      {uri + "ns=1;i=2: Input[0]", "no label", "A"},
                      {uri + "ns=1;i=2: [1].Max", "no label", "Line.Max"},
                      {uri + "ns=1;i=3", "a node", "nothing"},
                      {uri + "ns=1;i=4", "nothing", "a node"}});
    second = first;
    second.models.erase(second.models.begin());
    CHECK(model_differences(first, second) ==
          Differences{{"http://press.example/types", "a model", "nothing"}});
    CHECK(model_differences(second, first) ==
          Differences{{"http://press.example/types", "nothing", "a model"}});
    // What is no XML is compared, too.
    second = first;
    second.models[0].text = "<UANodeSet";
    CHECK_FALSE(model_differences(first, second).empty());
    CHECK(model_differences(second, second).empty());
}

} // namespace project_compare_test
