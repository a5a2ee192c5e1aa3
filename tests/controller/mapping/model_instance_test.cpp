#include <busbar/controller/model_instance.hpp>

#include <busbar/controller/mappable_parts.hpp>
#include <busbar/model/instance.hpp>

#include "mapping_fixture.hpp"

namespace model_instance_test {

using namespace busbar;
using namespace busbar::controller;

// Instances of a companion specification's types, which has types only.

namespace {

std::string reference(const std::string& type, const std::string& target, bool is_forward = true)
{
    return "<Reference ReferenceType=\"" + type + "\"" +
           (is_forward ? "" : " IsForward=\"false\"") + ">" + target + "</Reference>";
}

/// A node of a type with a ModellingRule: i=78 Mandatory, i=80 Optional.
std::string member(const std::string& node_class, const std::string& name,
                   const std::string& parent, const std::string& rule,
                   const std::string& attributes = {}, const std::string& more = {})
{
    return "<UA" + node_class + " NodeId=\"ns=1;s=" + parent + "." + name +
           "\" BrowseName=\"1:" + name + "\" " + attributes + "><References>" +
           reference("i=47", "ns=1;s=" + parent, false) + reference("i=37", rule) + more +
           "</References>";
}

std::string type(const std::string& name, const std::string& super, const std::string& attributes)
{
    return "<UAObjectType NodeId=\"ns=1;s=" + name + "\" BrowseName=\"1:" + name + "\" " +
           attributes + "><References>" + reference("i=45", super, false) +
           "</References></UAObjectType>\n";
}

const std::string arguments =
    "<UAVariable NodeId=\"ns=1;s=In\" BrowseName=\"InputArguments\" DataType=\"i=296\" "
    "ValueRank=\"1\" ArrayDimensions=\"1\"><References>" +
    reference("i=46", "ns=1;s=DriveType.Go", false) + reference("i=40", "i=68") +
    reference("i=37", "i=78") +
    "</References><Value><ListOfExtensionObject "
    "xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\"><ExtensionObject><TypeId>"
    "<Identifier>i=297</Identifier></TypeId><Body><Argument><Name>Speed</Name><DataType>"
    "<Identifier>i=4</Identifier></DataType><ValueRank>-1</ValueRank><ArrayDimensions/>"
    "</Argument></Body></ExtensionObject></ListOfExtensionObject></Value></UAVariable>\n";

/// BaseType (abstract) has State; DriveType, below it, has Motor with Speed, Note and Go.
const std::string types =
    type("BaseType", "i=58", "IsAbstract=\"true\"") +
    member("Variable", "State", "BaseType", "i=78", "DataType=\"i=6\" AccessLevel=\"3\"",
           reference("i=40", "i=63")) +
    "</UAVariable>\n" + type("DriveType", "ns=1;s=BaseType", {}) + type("MotorType", "i=58", {}) +
    member("Variable", "Speed", "MotorType", "i=78", "DataType=\"i=11\" AccessLevel=\"3\"",
           reference("i=40", "i=63")) +
    "</UAVariable>\n" +
    member("Object", "Motor", "DriveType", "i=78", {}, reference("i=40", "ns=1;s=MotorType")) +
    "</UAObject>\n" +
    member("Variable", "Note", "DriveType", "i=80", "DataType=\"i=12\" AccessLevel=\"3\"",
           reference("i=40", "i=63")) +
    "</UAVariable>\n" + member("Method", "Go", "DriveType", "i=78") + "</UAMethod>\n" + arguments;

struct Fixture : ModelFixture {
    Fixture() { import(file("urn:companion", types), "companion.xml"); }

    [[nodiscard]] NewInstance drive(const std::string& name) const
    {
        NewInstance instance;
        instance.parent = NodeId{0, 85};
        instance.type = id("DriveType", "urn:companion");
        instance.name = name;
        instance.uri = "urn:own";
        return instance;
    }
    [[nodiscard]] std::string refused(const NewInstance& instance)
    {
        const auto files = models.files().size();
        const auto made = add_instance(models, instance);
        REQUIRE_FALSE(made);
        CHECK(models.files().size() == files);
        return text(made.error());
    }
    [[nodiscard]] bool is_there(const std::string& path) const
    {
        return models.space().find(id(path, "urn:own")) != model::no_node;
    }
    [[nodiscard]] std::size_t parts(const std::string& path)
    {
        return MappableParts{models}.of(models.space().find(id(path, "urn:own"))).size();
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "Instances have what the type and its supertypes make Mandatory")
{
    const auto made = add_instance(models, drive("Line"));
    INFO((made ? "" : text(made.error())));
    REQUIRE(made);
    CHECK(made->node == id("Line", "urn:own"));
    CHECK(is_there("Line/State"));
    CHECK(is_there("Line/Motor/Speed"));
    CHECK(is_there("Line/Go/InputArguments"));
    CHECK_FALSE(is_there("Line/Note"));
    CHECK(made->added == 6);
    // All of it can be mapped, and the Method with its argument.
    CHECK(parts("Line/State") == 1);
    CHECK(parts("Line/Motor/Speed") == 1);
    CHECK(parts("Line/Go") == 2);
    CHECK(check_mapping(models).reports.error_count() == 0);
}

TEST_CASE_METHOD(Fixture, "Instances keep their NodeIds and their mapping when more is added")
{
    REQUIRE(add_instance(models, drive("Line")));
    models.mapping().variables[id("Line/State", "urn:own")].value.label = "State";
    NewInstance more = drive("Line");
    more.optional = {"Note"};
    auto again = add_instance(models, more);
    REQUIRE(again);
    CHECK(again->added == 1);
    CHECK(is_there("Line/Note"));
    CHECK(label("Line/State", "urn:own") == "State");
    again = add_instance(models, more);
    REQUIRE(again);
    CHECK(again->added == 0);
    // Another one beside it, and one below it.
    REQUIRE(add_instance(models, drive("Second")));
    NewInstance inner = drive("Spare");
    inner.parent = id("Line", "urn:own");
    inner.type = id("MotorType", "urn:companion");
    REQUIRE(add_instance(models, inner));
    CHECK(is_there("Line/Spare/Speed"));
    CHECK(is_there("Second/Motor/Speed"));
    CHECK(label("Line/State", "urn:own") == "State");
    // What is exported is imported as the same.
    const std::string text = exported("urn:own");
    CHECK(text.find("companion") != std::string::npos);
    import(text, "own.xml");
    CHECK(exported("urn:own") == text);
}

TEST_CASE_METHOD(Fixture, "Instances that cannot be are refused, and nothing is changed")
{
    NewInstance wrong = drive("Line");
    wrong.type = id("BaseType", "urn:companion");
    CHECK(refused(wrong).find("BaseType, which is abstract") != std::string::npos);
    wrong.type = NodeId{0, 63'000};
    CHECK(refused(wrong).find("found no ObjectType") != std::string::npos);
    wrong = drive("Line");
    wrong.parent = NodeId{0, 63'000};
    CHECK(refused(wrong).find("found no Object") != std::string::npos);
    wrong = drive("a/b");
    CHECK(refused(wrong).find("has a slash") != std::string::npos);
    wrong = drive("Line");
    wrong.optional = {"Nothing"};
    CHECK(refused(wrong).find("no Optional member") != std::string::npos);
    REQUIRE(add_instance(models, drive("Line")));
    wrong = drive("Line");
    wrong.type = id("MotorType", "urn:companion");
    CHECK(refused(wrong).find("already exists with another type") != std::string::npos);
    wrong.uri = "urn:companion";
    wrong.name = "Other";
    CHECK(refused(wrong).find("namespace that models require") != std::string::npos);
}

TEST_CASE_METHOD(Fixture, "Instances have a chosen type where the model has an abstract one")
{
    const auto contains = [](const std::string& text, const std::string& part) {
        CAPTURE(text, part);
        return text.find(part) != std::string::npos;
    };
    import(file("urn:axes", type("AxisType", "i=58", {}) +
                                type("ToolType", "i=58", "IsAbstract=\"true\"") +
                                member("Object", "Tool", "AxisType", "i=78", {},
                                       reference("i=40", "ns=1;s=ToolType")) +
                                "</UAObject>\n"),
           "axes.xml");
    NewInstance axis = drive("Axis");
    axis.type = id("AxisType", "urn:axes");
    CHECK(contains(refused(axis), "has the member Tool of the abstract type"));
    CHECK(contains(refused(axis), "no model has a subtype"));
    import(file("urn:axes",
                type("AxisType", "i=58", {}) + type("ToolType", "i=58", "IsAbstract=\"true\"") +
                    member("Object", "Tool", "AxisType", "i=78", {},
                           reference("i=40", "ns=1;s=ToolType")) +
                    "</UAObject>\n" + type("DrillType", "ns=1;s=ToolType", {}) +
                    member("Variable", "Speed", "DrillType", "i=78",
                           "DataType=\"i=11\" AccessLevel=\"3\"", reference("i=40", "i=63")) +
                    "</UAVariable>\n"),
           "axes.xml");
    CHECK(contains(refused(axis), "--type Tool=TYPE): DrillType"));
    axis.types = {{"Tool", id("MotorType", "urn:companion")}};
    CHECK(contains(refused(axis), "MotorType was chosen, expected a subtype of"));
    axis.types = {{"Tool", id("ToolType", "urn:axes")}};
    CHECK(contains(refused(axis), "that is not abstract: DrillType"));
    const NodeId drill = id("DrillType", "urn:axes");
    axis.types = {{"Tool", drill}, {"Tol", drill}};
    CHECK(contains(refused(axis), "gets no member Tol"));
    axis.types = {{"Tool", drill}};
    const auto made = add_instance(models, axis);
    INFO((made ? "" : text(made.error())));
    REQUIRE(made);
    CHECK(is_there("Axis/Tool/Speed"));
    // The same again is no change, another type is.
    REQUIRE(add_instance(models, axis));
    axis.types = {{"Tool", id("MotorType", "urn:companion")}};
    CHECK(contains(refused(axis), "already, which stays"));
}

} // namespace model_instance_test
