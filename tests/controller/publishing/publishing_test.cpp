#include <catch2/catch.hpp>

#include "program_parts.hpp"

namespace publishing_test {

using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

const TypeUse an_int = use(ElementaryType::Int);

} // namespace

TEST_CASE("What the attribute Network Publish says is published (3-3-1)")
{
    Program program;
    program.variables = {variable("A"), variable("B"), variable("C"), variable("D")};
    program.variables[0].publish = NetworkPublish::Hidden;
    program.variables[1].publish = NetworkPublish::Input;
    program.variables[2].publish = NetworkPublish::Output;
    CHECK(Published{program}.names() == std::vector<std::string>{"B", "C", "D"});
}

TEST_CASE("Order is that of UTF-16 with letters compared without case (6-2-2, step 1)")
{
    Program program;
    // U+1D11E is D834 DD1E in UTF-16, and so before U+FF21, a wide A.
    for (const char* name : {"\xEF\xBC\xA1", "b", "\xF0\x9D\x84\x9E", "A_B", "C", "a1", "9", "AB",
                             "10", "\xC3\xA9", "\xC3\x89", "\xE3\x81\x82"}) {
        program.variables.push_back(variable(name));
    }
    // '_' is behind the capitals that letters are compared as; e with accent has a case still.
    CHECK(Published{program}.names() ==
          std::vector<std::string>{"10", "9", "a1", "AB", "A_B", "b", "C", "\xC3\x89", "\xC3\xA9",
                                   "\xE3\x81\x82", "\xF0\x9D\x84\x9E", "\xEF\xBC\xA1"});
}

TEST_CASE("Values are variables, elements, and what is in structures (6-2-2, *1)")
{
    Program program;
    program.types = {
        structure("Inner", {an_int, array_of(an_int, {{0, 3}})}), // 5
        structure("Outer", {use("Inner"), array_of(use("Inner"), {{0, 1}}), an_int}),
        {.name = "Mode", .kind = DerivedType::Kind::Enumeration, .enumerators = {{"Off", 0}}}};
    program.variables = {variable("A"), variable("B", array_of(an_int, {{0, 1}, {0, 2}})),
                         variable("C", use("Outer")),
                         variable("D", array_of(use("Inner"), {{0, 9}})),
                         variable("E", use("Mode"))};
    const Published published{program};
    std::vector<std::uint64_t> values;
    for (const PublishedVariable& one : published.publication.published()) {
        values.push_back(one.values);
    }
    CHECK(values == std::vector<std::uint64_t>{1, 6, 16, 50, 1});
    CHECK(published.publication.values() == 74);
}

TEST_CASE("A structure definition counts once, with those within it (6-2-2, *2)")
{
    Program program;
    program.types = {
        structure("In", {an_int}),
        structure("InArray", {an_int}),
        structure("Out", {use("In"), use("IN"), array_of(use("InArray"), {{0, 1}})}),
        structure("Unused", {an_int}),
        {.name = "Mode", .kind = DerivedType::Kind::Enumeration, .enumerators = {{"Off", 0}}}};
    program.variables = {variable("A", use("Out")), variable("B", use("out")),
                         variable("C", use("In")), variable("D", use("Mode")),
                         variable("E", array_of(an_int, {{0, 1}}))};
    CHECK(Published{program}.publication.data_types() == 3);
}

TEST_CASE("The 10,001st variable is not published (1-2-2)")
{
    Program program{.variables = numbered(10'000)};
    CHECK(Published{program}.publication.status_bits() == 0);
    program.variables.push_back(variable("A")); // the last that was declared, the first by name
    const Published published{program};
    CHECK(published.publication.published().size() == 10'000);
    CHECK(published.names().front() == "A");
    CHECK(published.names().back() == "V09998");
    CHECK(published.publication.left_out() == 1);
    CHECK(published.publication.exceeds(PublishingLimit::Variables));
    // Each of them has a value at least; but the first limit is told, and no other.
    CHECK(published.publication.status_bits() == 1);
}

TEST_CASE("The 10,001st value is not published (6-2-2)")
{
    Program program;
    for (int i = 0; i < 10; ++i) {
        program.variables.push_back(
            variable("A" + std::to_string(i), array_of(use(ElementaryType::Bool), {{0, 998}})));
    }
    program.variables.push_back(variable("B", array_of(an_int, {{0, 9}})));
    CHECK(Published{program}.publication.values() == 10'000);
    CHECK(Published{program}.publication.status_bits() == 0);
    program.variables.back().type = array_of(an_int, {{0, 10}});
    const Published published{program};
    CHECK(published.publication.published().size() == 10);
    CHECK(published.publication.status_bits() == 2);
}

TEST_CASE("The 101st structure definition is not published (6-2-2, *2)")
{
    Program program;
    for (int i = 100; i < 200; ++i) {
        const std::string number = std::to_string(i);
        program.types.push_back(structure("T" + number, {an_int}));
        program.variables.push_back(variable("V" + number, use("T" + number)));
    }
    program.variables.push_back(variable("W", use("T100")));
    CHECK(Published{program}.publication.published().size() == 101);
    CHECK(Published{program}.publication.status_bits() == 0);
    program.types.push_back(structure("T200", {use("T100")}));
    program.variables.push_back(variable("X", use("T200")));
    program.variables.push_back(variable("Y"));
    const Published published{program};
    CHECK(published.publication.data_types() == 100);
    CHECK(published.publication.status_bits() == 4);
    CHECK(published.names().back() == "W"); // Y is no structure, but comes later
    CHECK(published.publication.left_out() == 2);
}

TEST_CASE("What comes first ends the list, however small the rest is (6-2-2, step 2)")
{
    PublishingLimits limits = nj501_publishing();
    limits.max_values = 10;
    Program program;
    program.types = {union_of("Either", {an_int})};
    program.variables = {variable("A", array_of(an_int, {{0, 7}})),
                         variable("B", array_of(an_int, {{0, 2}})), variable("C")};
    SECTION("a smaller variable after it is not published either")
    {
        const Published published{program, limits};
        CHECK(published.names() == std::vector<std::string>{"A"});
        CHECK(published.publication.left_out() == 2);
    }
    SECTION("the limits over all come first, also for one that has a fault of its own")
    {
        program.variables[1].type.dimensions = {{1, 3}};
        const Published published{program, limits};
        CHECK(published.publication.unpublished().empty());
        CHECK(published.publication.status_bits() == 2);
    }
    SECTION("what is not published by itself takes no room")
    {
        program.variables[0].type.dimensions = {{1, 8}};
        const Published published{program, limits};
        CHECK(published.names() == std::vector<std::string>{"B", "C"});
        CHECK(published.publication.values() == 4);
        CHECK(published.publication.status_bits() == 8);
    }
}

TEST_CASE("Without limits everything is published (6-2-2)")
{
    Program program{.variables = numbered(30'000)};
    program.types = {structure("S", std::vector<TypeUse>(1'000, an_int)),
                     union_of("U", {use("S"), an_int})};
    program.variables[7].type = array_of(use("U"), {{1, 2}, {3, 5}});
    const Published published{program, {}};
    CHECK(published.publication.published().size() == 30'000);
    CHECK(published.publication.published()[7].values == 6'000);
    CHECK(published.publication.published()[7].size == 12'000);
    CHECK(published.publication.data_types() == 2);
    CHECK(published.publication.status_bits() == 0);
}

TEST_CASE("Variables added online are sorted among themselves (6-2-2, online editing)")
{
    Published first{{.types = tower(1), .variables = {variable("m"), variable("N")}}};
    Program edited = first.program;
    edited.types.push_back(structure("New", {use("T1")}));
    edited.variables.push_back(variable("b", use("New")));
    edited.variables.push_back(variable("A", array_of(an_int, {{1, 2}})));
    edited.variables.push_back(variable("a2"));
    const ProgramTypes types = ProgramTypes::create(edited).value();
    const PublicationGroup group = first.publication.add(types);
    CHECK(first.names() == std::vector<std::string>{"m", "N", "a2", "b"});
    CHECK(group.first_published == 2);
    CHECK(group.first_unpublished == 0);
    CHECK(first.publication.unpublished().at(0).variable->name == "A");
    CHECK(first.publication.data_types() == 2);
    CHECK(first.publication.status_bits() == 8);
    // All names are known now.
    CHECK(first.publication.add(types).first_published == 4);
    CHECK(first.names().size() == 4);
}

TEST_CASE("Nothing is checked online once a limit is reached (6-2-2, online editing)")
{
    PublishingLimits limits = nj501_publishing();
    limits.max_values = 2;
    Published first{{.variables = {variable("A"), variable("B")}}, limits};
    CHECK(first.publication.status_bits() == 0);
    const Program edit{.variables = {variable("C"), variable("D", array_of(an_int, {{1, 2}}))}};
    const ProgramTypes types = ProgramTypes::create(edit).value();
    const PublicationGroup group = first.publication.add(types);
    CHECK(group.exceeded == PublishingLimit::Values);
    CHECK(first.publication.unpublished().empty()); // D was not looked at
    CHECK(first.publication.left_out() == 2);
    CHECK(first.publication.status_bits() == 2);

    SECTION("nor once one was exceeded, though there is room")
    {
        limits.max_values = 3;
        Published second{{.variables = {variable("A"), variable("B"),
                                        variable("C", array_of(an_int, {{0, 1}}))}},
                         limits};
        CHECK(second.publication.values() == 2);
        const Program more{.variables = {variable("E")}};
        const ProgramTypes more_types = ProgramTypes::create(more).value();
        CHECK(second.publication.add(more_types).exceeded == PublishingLimit::Values);
        CHECK(second.names() == std::vector<std::string>{"A", "B"});
    }
    SECTION("a group without published variables is no edit")
    {
        Program hidden{.variables = {variable("E")}};
        hidden.variables[0].publish = NetworkPublish::Hidden;
        const ProgramTypes hidden_types = ProgramTypes::create(hidden).value();
        CHECK_FALSE(first.publication.add(hidden_types).exceeded);
    }
}

} // namespace publishing_test
