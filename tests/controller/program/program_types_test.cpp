#include <catch2/catch.hpp>

#include <busbar/controller/program_types.hpp>

namespace program_types_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

TypeUse use(ElementaryType type)
{
    return {.elementary = type};
}

TypeUse use(std::string type)
{
    return {.type_name = std::move(type)};
}

TypeUse array_of(TypeUse type, std::vector<Bounds> bounds)
{
    type.dimensions = std::move(bounds);
    return type;
}

DerivedType structure(std::string name, std::vector<TypeUse> members)
{
    DerivedType type{.name = std::move(name)};
    for (TypeUse& member : members) {
        type.members.push_back({"m" + std::to_string(type.members.size()), std::move(member)});
    }
    return type;
}

DerivedType alias(std::string name, TypeUse type)
{
    return {.name = std::move(name), .kind = DerivedType::Kind::Alias, .alias = std::move(type)};
}

std::string problem_of(const Program& program, const ProgramLimits& limits = {})
{
    const auto types = ProgramTypes::create(program, limits);
    return types ? "" : text(types.error());
}

} // namespace

TEST_CASE("Names of types are followed, whatever their case (6-2-2)")
{
    Program program;
    program.types = {alias("Row", array_of(use(ElementaryType::Real), {{0, 2}})),
                     alias("Table", array_of(use("ROW"), {{1, 4}})),
                     structure("Point", {use("row")})};
    program.types[0].initial.value = Variant{1.5};
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);

    const ResolvedType table = types->resolve(array_of(use("table"), {{0, 1}}));
    CHECK(table.kind == ResolvedType::Kind::Elementary);
    CHECK(table.elementary == ElementaryType::Real);
    CHECK(table.dimensions == std::vector<Bounds>{{0, 1}, {1, 4}, {0, 2}});
    CHECK(table.elements() == 24);
    CHECK(table.initial == &program.types[0].initial);
    CHECK(types->resolve(use("POINT")).type == &program.types[2]);
    CHECK(types->find("none") == nullptr);
}

TEST_CASE("What variables take (7-1-7)")
{
    Program program;
    program.types = {structure("Inner", {use(ElementaryType::Int), use(ElementaryType::Bool)}),
                     structure("Outer", {use("Inner"), array_of(use("Inner"), {{0, 9}})}),
                     structure("Either", {use("Inner"), use(ElementaryType::Lreal)}),
                     {.name = "Mode",
                      .kind = DerivedType::Kind::Enumeration,
                      .enumerators = {{"Off", 0}, {"On", 1}}}};
    program.types[2].kind = DerivedType::Kind::Union;
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);
    CHECK(types->size_of(use(ElementaryType::Bool)) == 1);
    CHECK(types->size_of(use(ElementaryType::Int)) == 2);
    CHECK(types->size_of(use(ElementaryType::Time)) == 8);
    CHECK(types->size_of({.elementary = ElementaryType::String, .string_length = 20}) == 21);
    CHECK(types->size_of(use("Inner")) == 3);
    CHECK(types->size_of(use("Outer")) == 33);
    CHECK(types->size_of(use("Either")) == 8);
    CHECK(types->size_of(array_of(use("Mode"), {{0, 4}})) == 20);
}

TEST_CASE("A program that makes no sense is refused, with its place")
{
    Program program;
    program.types = {structure("A", {use(ElementaryType::Int)})};
    program.variables = {{.name = "x", .type = use("A")}};
    REQUIRE(problem_of(program) == "");

    SECTION("a type that is not there")
    {
        program.variables[0].type.type_name = "B";
        program.variables[0].place = {12, 5};
        CHECK(problem_of(program) ==
              "12:5: variables[0] (x): is of the type B, which is not declared");
    }
    SECTION("a name twice")
    {
        program.variables.push_back({.name = "X", .type = use("A")});
        CHECK(problem_of(program) == "variables[1] (X): is the name of another variable, too");
        program.variables.pop_back();
        program.types.push_back(structure("a", {use(ElementaryType::Int)}));
        CHECK(problem_of(program) == "types[1] (a): is the name of another type, too");
    }
    SECTION("a type within itself, at some remove")
    {
        program.types.push_back(structure("B", {use("C")}));
        program.types.push_back(alias("C", array_of(use("B"), {{0, 1}})));
        CHECK(problem_of(program) == "types[1] (B): contains itself");
    }
    SECTION("bounds, subranges and names")
    {
        program.variables[0].type.dimensions = {{3, 2}};
        CHECK(
            problem_of(program) ==
            "variables[0] (x): has the bounds 3..2; expected a lower and an upper one of 32 bits");
        program.variables[0].type.dimensions = {{0, 1LL << 40}};
        CHECK(problem_of(program) != "");
        program.variables[0].type = {.subrange = Bounds{1, 0}};
        CHECK(problem_of(program) == "variables[0] (x): has a subrange without any value");
        program.variables[0] = {.name = "\xc3("};
        CHECK(problem_of(program).find("not UTF-8") != std::string::npos);
    }
    SECTION("too large")
    {
        program.variables[0].type.dimensions = {{0, INT32_MAX - 1}, {0, INT32_MAX - 1}};
        CHECK(problem_of(program) == "variables[0] (x): has more than 67108864 bytes");
    }
}

TEST_CASE("Types that lie twice in one another cost no more than others")
{
    Program program;
    program.types = {structure("T0", {use(ElementaryType::Bool)})};
    for (int i = 1; i < 64; ++i) {
        const std::string below = "T" + std::to_string(i - 1);
        program.types.push_back(structure("T" + std::to_string(i), {use(below), use(below)}));
    }
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);
    CHECK(types->size_of(use("T10")) == 1024);
    CHECK(types->size_of(use("T63")) >= 1ULL << 56U); // as much as is counted
    program.types.push_back(structure("T64", {use("T63")}));
    CHECK(problem_of(program).find("more than 64 types") != std::string::npos);
    std::reverse(program.types.begin(), program.types.end());
    CHECK(problem_of(program).find("more than 64 types") != std::string::npos);
}

TEST_CASE("Dimensions of types within one another are counted together (6-2-2)")
{
    Program program;
    program.types = {alias("A", array_of(use(ElementaryType::Int), std::vector<Bounds>(10))),
                     alias("B", array_of(use("A"), std::vector<Bounds>(6)))};
    program.variables = {{.name = "x", .type = use("B")}};
    CHECK(problem_of(program).empty());
    program.variables[0].type = array_of(use("B"), {{0, 0}});
    CHECK(problem_of(program) ==
          "variables[0] (x): has more than 16 dimensions with those of its types");
    program.types.push_back(structure("S", {array_of(use("B"), {{0, 0}})}));
    CHECK(problem_of(program) == "type S: has more than 16 dimensions with those of its types");
}

} // namespace program_types_test
