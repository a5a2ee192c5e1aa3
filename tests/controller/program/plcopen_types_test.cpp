#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/plcopen_xml.hpp>

#include "shown_program.hpp"

namespace plcopen_types_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// What is served of a variable v of this type, with these <dataType>s before it.
std::string served(const std::string& type, const std::string& types = "")
{
    const std::string text =
        "<project xmlns=\"http://www.plcopen.org/xml/tc6_0200\"><types><dataTypes>" + types +
        "</dataTypes></types><instances><configurations><configuration name=\"C\"><globalVars>"
        "<variable name=\"v\"><type>" +
        type +
        "</type></variable></globalVars></configuration></configurations></instances></project>";
    return controller::test::shown(read_plcopen_xml(text, "m.xml", {}, Unserved::LeaveOut));
}

std::string member(const std::string& name, const std::string& type)
{
    return "<variable name=\"" + name + "\"><type>" + type + "</type></variable>";
}

/// A structure as a <dataType>, which extends `base` if that is not empty.
std::string structure(const std::string& name, const std::string& members,
                      const std::string& base = "")
{
    const std::string data = "<addData><data name=\"http://www.3s-software.com/plcopenxml/"
                             "datatypeinheritance\" handleUnknown=\"implementation\"><Inheritance>"
                             "<Extends>" +
                             base + "</Extends></Inheritance></data></addData>";
    return "<dataType name=\"" + name + "\"><baseType><struct>" + members + "</struct></baseType>" +
           (base.empty() ? "" : data) + "</dataType>";
}

} // namespace

TEST_CASE("Types of the 3rd edition are served from PLCopen XML")
{
    CHECK(served("<wstring length=\"20\"/>") == "v WSTRING(20)");
    CHECK(served("<wstring/>") == "v WSTRING(255)");
    // The schema lacks these, so that tools write them as names.
    CHECK(served("<derived name=\"LTIME\"/>") == "v LTIME");
    CHECK(served("<derived name=\"BIT\"/>") == "v BOOL");
    CHECK(served("<LTIME/>") == "v LTIME");
    CHECK(served("<derived name=\"TON\"/>") == "- v is of the type TON, which is not declared");
}

TEST_CASE("Structures and enumerations without a name are served from PLCopen XML")
{
    CHECK(served("<struct>" + member("a", "<INT/>") +
                 member("b", "<enum><values><value name=\"On\"/></values></enum>") + "</struct>") ==
          "v (a INT, b (On=0))");
    CHECK(served("<array><dimension lower=\"0\" upper=\"1\"/><baseType><struct>" +
                 member("a", "<BOOL/>") + "</struct></baseType></array>") == "v [0..1](a BOOL)");
    std::string deep = "<INT/>";
    for (int i = 0; i < 40; ++i) {
        deep = "<struct>" + member("a", deep) + "</struct>";
    }
    CHECK(served(deep) == "- v is within more than 32 structures");
}

TEST_CASE("A structure of PLCopen XML that extends another one has its members first")
{
    const std::string x = member("x", "<INT/>");
    const std::string y = member("y", "<BOOL/>");
    const std::string v = "<derived name=\"B\"/>";
    CHECK(served(v, structure("B", y, "A") + structure("A", x)) == "v (x INT, y BOOL)");
    CHECK(served(v, structure("B", y, "A") + structure("A", x, "B")) ==
          "- A extends itself; - B extends A, which is left out; "
          "- v is of the type B, which is left out");
    CHECK(served(v, structure("B", y, "Lib")) ==
          "- B extends Lib, which is not declared or left out; "
          "- v is of the type B, which is left out");
}

} // namespace plcopen_types_test
