#include <busbar/controller/mapping_check.hpp>

#include "mapping_fixture.hpp"

namespace node_places_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// A Variable with its references.
std::string node(const std::string& id, const std::string& references,
                 const std::string& element = "UAVariable")
{
    const std::string type = element == "UAVariable" ? "i=63" : "i=58";
    return "<" + element + " NodeId=\"ns=1;s=" + id + "\" BrowseName=\"1:" + id +
           "\"><References>" + references + "<Reference ReferenceType=\"i=40\">" + type +
           "</Reference></References></" + element + ">\n";
}

std::string from(const std::string& source, const std::string& type = "i=35")
{
    return "<Reference ReferenceType=\"" + type + "\" IsForward=\"false\">" + source +
           "</Reference>";
}

struct PlacesFixture : ModelFixture {
    NodePlace place(const std::string& name, const std::vector<std::string>& required = {})
    {
        return NodePlaces{models.space(), required}.of(models.space().find(id(name)));
    }
};

} // namespace

TEST_CASE("9.5 Targets: where nodes stand", "[9.5]")
{
    PlacesFixture project;
    project.import(
        file("urn:t", node("Good", from("i=85")) + node("Server", from("i=2253", "i=47")) +
                          node("Aliases", from("i=23470", "i=47")) + node("Lost", {}) +
                          node("Object", from("i=85"), "UAObject") +
                          node("Inner", from("ns=1;s=Object", "i=47")) +
                          // The same node in two places.
                          node("Both", from("i=85") + from("i=2253", "i=47")) +
                          // The Server refers to it as a source of events only.
                          node("Source", from("i=85") + from("i=2253", "i=36"), "UAObject") +
                          node("InSource", from("ns=1;s=Source", "i=47")) +
                          node("OfType", from("i=58", "i=47") + from("i=85"))));
    CHECK(project.place("Good") == NodePlace::Mappable);
    CHECK(project.place("Server") == NodePlace::BelowServer);
    CHECK(project.place("Aliases") == NodePlace::BelowAliases);
    CHECK(project.place("Lost") == NodePlace::NotBelowObjects);
    CHECK(project.place("Object") == NodePlace::WrongNodeClass);
    CHECK(project.place("Inner") == NodePlace::Mappable);
    CHECK(project.place("Both") == NodePlace::BelowServer);
    CHECK(project.place("InSource") == NodePlace::Mappable);
    CHECK(project.place("OfType") == NodePlace::NotBelowObjects);
    CHECK(project.place("Good", {"urn:t"}) == NodePlace::RequiredNamespace);
    CHECK(project.place("Server", {"urn:t"}) == NodePlace::BelowServer);
    const NodePlaces places{project.models.space(), {}};
    const auto& space = project.models.space();
    CHECK(places.of(space.find(id::Server_ServerStatus)) == NodePlace::StandardNode);
    CHECK(places.level(space.find(project.id("Good"))) == 1);
    CHECK(places.level(space.find(project.id("Inner"))) == 2);
    CHECK(places.level(space.find(project.id("Server"))) == 0);
    CHECK(places.is_counted(space.find(project.id("Good"))));
    CHECK_FALSE(places.is_counted(space.find(project.id("Server"))));
    CHECK_FALSE(places.is_counted(space.find(project.id("Lost"))));
    CHECK_FALSE(places.is_counted(space.find(project.id("Object"))));
}

TEST_CASE("9.5 Targets: the properties of a Method's arguments", "[9.5]")
{
    PlacesFixture project;
    const std::string arguments =
        "<UAVariable NodeId=\"ns=1;s=In\" BrowseName=\"InputArguments\" DataType=\"i=296\" "
        "ValueRank=\"1\" ArrayDimensions=\"0\"><References>" +
        from("ns=1;s=M", "i=46") +
        "<Reference ReferenceType=\"i=40\">i=68</Reference></References></UAVariable>";
    project.import(file("urn:t", cell() + method("s=M") + arguments));
    CHECK(project.place("M") == NodePlace::Mappable);
    CHECK(project.place("In") == NodePlace::ArgumentsProperty);
    const NodePlaces places{project.models.space(), {}};
    CHECK_FALSE(places.is_counted(project.models.space().find(project.id("In"))));
}

TEST_CASE("9.5 Targets: references in a circle end", "[9.5]")
{
    PlacesFixture project;
    project.import(file("urn:t", node("A", from("i=85") + from("ns=1;s=B"), "UAObject") +
                                     node("B", from("ns=1;s=A"), "UAObject") +
                                     node("V", from("ns=1;s=B"))));
    CHECK(project.place("V") == NodePlace::Mappable);
}

} // namespace node_places_test
