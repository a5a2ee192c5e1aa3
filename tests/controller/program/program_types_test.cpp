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
    REQUIRE(table.initials.size() == 1);
    CHECK(table.initials[0].value == &program.types[0].initial);
    CHECK(table.initials[0].level == 2);
    CHECK(types->resolve(use("POINT")).type == &program.types[2]);
    CHECK(types->find("none") == nullptr);
}

TEST_CASE("What variables take in the CPU (7-1-7; W506, A-5-1)")
{
    using E = ElementaryType;
    const auto text = [](std::uint32_t length) {
        return TypeUse{.elementary = E::String, .string_length = length};
    };
    const std::vector<TypeUse> hundred(100, use(E::Bool));
    Program program;
    program.types = {
        structure("IntBool", {use(E::Int), use(E::Bool)}),
        structure("Outer", {use("IntBool"), array_of(use("IntBool"), {{0, 9}})}),
        structure("Either", {use("IntBool"), use(E::Lreal), text(9)}),
        structure("BoolDintBool", {use(E::Bool), use(E::Dint), use(E::Bool)}),
        structure("BoolLreal", {use(E::Bool), use(E::Lreal)}),
        structure("Bytes", {use(E::Byte), use(E::Usint), use(E::Sint)}),
        structure("ByteText", {use(E::Byte), text(1), use(E::Word)}),
        structure("ByteInner", {use(E::Byte), use("BoolLreal"), use(E::Byte)}),
        structure("Bits", {use(E::Byte), array_of(use(E::Bool), {{0, 16}}), use(E::Byte)}),
        structure("ModeByte", {use("Mode"), use(E::Byte)}),
        alias("Flags", array_of(use(E::Bool), {{0, 3}})),
        {.name = "Mode",
         .kind = DerivedType::Kind::Enumeration,
         .enumerators = {{"Off", 0}, {"On", 1}}}};
    program.types[2].kind = DerivedType::Kind::Union;
    program.types.push_back(structure("Hundred", hundred));
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);

    struct Row {
        TypeUse use;
        std::uint64_t size;
        std::uint64_t in_image;
    };
    for (const Row& row : {
             Row{use(E::Bool), 2, 1},
             Row{use(E::Sint), 1, 1},
             Row{use(E::Byte), 1, 1},
             Row{use(E::Int), 2, 2},
             Row{use(E::Real), 4, 4},
             Row{use(E::Lreal), 8, 8},
             Row{use(E::Time), 8, 8},
             Row{use(E::Date), 8, 8},
             Row{text(20), 21, 24},
             Row{use("Mode"), 4, 4},
             Row{array_of(use("Mode"), {{0, 4}}), 20, 20},
             Row{array_of(use(E::Byte), {{0, 2}}), 3, 3},
             // Bits of words.
             Row{array_of(use(E::Bool), {{0, 0}}), 2, 1},
             Row{array_of(use(E::Bool), {{0, 15}}), 2, 16},
             Row{array_of(use(E::Bool), {{1, 17}}), 4, 17},
             Row{array_of(use(E::Bool), {{0, 9}, {0, 9}}), 14, 100},
             Row{use("Flags"), 2, 4},
             // Members at multiples of their own alignment, and an end at the largest one's.
             Row{use("IntBool"), 4, 4},
             Row{use("Outer"), 44, 44},
             Row{use("Either"), 16, 16},
             Row{use("BoolDintBool"), 12, 12},
             Row{use("BoolLreal"), 16, 16},
             Row{array_of(use("BoolLreal"), {{0, 99}}), 1'600, 1'600},
             Row{use("Bytes"), 3, 3},
             Row{array_of(use("Bytes"), {{0, 9}}), 30, 30},
             Row{use("ByteText"), 6, 16},
             Row{use("ByteInner"), 32, 32},
             Row{use("Bits"), 8, 19},
             Row{use("ModeByte"), 8, 8},
             Row{use("Hundred"), 200, 100},
         }) {
        INFO(row.use.type_name << " " << static_cast<int>(row.use.elementary) << " "
                               << row.use.dimensions.size());
        CHECK(types->size_of(row.use) == row.size);
        CHECK(types->size_of(row.use, ValueMemory::Image) == row.in_image);
    }
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
        CHECK(problem_of(program) == "variables[1] (X): is also the name of another variable");
        program.variables.pop_back();
        program.types.push_back(structure("a", {use(ElementaryType::Int)}));
        CHECK(problem_of(program) == "types[1] (a): is also the name of another type");
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
    SECTION("too large in a process image, though bits in the CPU")
    {
        program.types.push_back(structure("Bits", {array_of(use(ElementaryType::Bool), {{0, 7}})}));
        program.variables[0].type = array_of(use(ElementaryType::Bool), {{1, 64 << 20}});
        CHECK(problem_of(program) == "");
        program.variables[0].type = array_of(use(ElementaryType::Bool), {{0, 64 << 20}});
        const std::string refused = "variables[0] (x): has more than 67108864 bytes in a process "
                                    "image, which keeps one for each BOOL";
        CHECK(problem_of(program) == refused);
        program.variables[0].type = array_of(use("Bits"), {{1, 8 << 20}});
        CHECK(problem_of(program) == "");
        program.variables[0].type = array_of(use("Bits"), {{0, 8 << 20}});
        CHECK(problem_of(program) == refused);
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
    CHECK(types->size_of(use("T10")) == 2048);
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
