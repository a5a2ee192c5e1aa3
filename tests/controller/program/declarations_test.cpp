#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>

namespace declarations_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// What the text declares; a problem fails the test.
Program program_of(std::string_view text)
{
    auto program = read_declarations(text, "a.st");
    if (!program) {
        FAIL(busbar::text(program.error()));
    }
    return std::move(*program);
}

DerivedType type_of(const std::string& declaration)
{
    Program program = program_of("TYPE " + declaration + " END_TYPE");
    REQUIRE(program.types.size() == 1);
    return std::move(program.types.front());
}

GlobalVariable variable_of(const std::string& declaration)
{
    Program program = program_of("VAR_GLOBAL " + declaration + " END_VAR");
    REQUIRE(program.variables.size() == 1);
    return std::move(program.variables.front());
}

NetworkPublish published_as(const std::string& pragma)
{
    return variable_of(pragma + " x : INT;").publish;
}

} // namespace

TEST_CASE("Structures and unions are declared with their members (6-2-2)")
{
    const DerivedType point = type_of("Point : STRUCT X, Y : INT := 5; Name : STRING[20];"
                                      " Row : ARRAY[0..2, -1..1] OF Mode; END_STRUCT;");
    CHECK(point.name == "Point");
    CHECK(point.kind == DerivedType::Kind::Structure);
    REQUIRE(point.members.size() == 4);
    CHECK(point.members[0].name == "X");
    CHECK(point.members[1].name == "Y");
    CHECK(point.members[1].initial.value == Variant{std::int64_t{5}});
    CHECK(point.members[1].place.column == 24);
    CHECK(point.members[2].type.elementary == ElementaryType::String);
    CHECK(point.members[2].type.string_length == 20);
    CHECK(point.members[3].type.type_name == "Mode");
    CHECK(point.members[3].type.dimensions == std::vector<Bounds>{{0, 2}, {-1, 1}});

    const DerivedType either = type_of("Either : UNION A : LREAL; B : LWORD; END_UNION");
    CHECK(either.kind == DerivedType::Kind::Union);
    CHECK(either.members.size() == 2);
    CHECK(type_of("p : struct a : bool; end_struct := (a := TRUE);").initial.parts.size() == 1);
}

TEST_CASE("Enumerations are declared with or without values and a base type (6-2-2)")
{
    const auto values = [](const std::string& declaration) {
        const DerivedType type = type_of(declaration);
        CHECK(type.kind == DerivedType::Kind::Enumeration);
        CHECK(type.alias.elementary == TypeUse{}.elementary);
        std::string text;
        for (const Enumerator& one : type.enumerators) {
            text += one.name + "=" + std::to_string(one.value) + " ";
        }
        return text;
    };
    CHECK(values("M : (Off, On);") == "Off=0 On=1 ");
    CHECK(values("M : (Off := -1, On, Far := 16#10);") == "Off=-1 On=0 Far=16 ");
    CHECK(values("M : (Off, On) USINT;") == "Off=0 On=1 ");
    CHECK(values("M : USINT (Off, On := 255);") == "Off=0 On=255 ");
    CHECK(values("M : (Off, On) := On;") == "Off=0 On=1 ");
    CHECK(type_of("M : DINT (Off, On) := On;").initial.value == Variant{String{"On"}});
    CHECK(type_of("M : (Off, On) DINT := M#On;").initial.enumeration == "M");
}

TEST_CASE("Subranges, arrays, texts and other names are declared as types (6-2-2)")
{
    const DerivedType percent = type_of("Percent : INT (0..100) := 50; (* how full *)");
    CHECK(percent.kind == DerivedType::Kind::Alias);
    CHECK(percent.alias.elementary == ElementaryType::Int);
    CHECK(percent.alias.subrange == Bounds{0, 100});
    CHECK(percent.initial.value == Variant{std::int64_t{50}});
    CHECK(percent.comment == "how full");

    const DerivedType table = type_of("Table : ARRAY[1..2] OF ARRAY[3..4, 5..6] OF Percent;");
    CHECK(table.alias.dimensions == std::vector<Bounds>{{1, 2}, {3, 4}, {5, 6}});
    CHECK(table.alias.type_name == "Percent");
    CHECK(type_of("S : STRING(8);").alias.string_length == 8);
    CHECK(type_of("S : STRING;").alias.string_length == 255);
    CHECK(type_of("A : Percent;").alias.type_name == "Percent");
}

TEST_CASE("Variables have the attributes of their block (6-2-2)")
{
    const Program program = program_of("VAR_GLOBAL CONSTANT a : INT := 1; END_VAR\n"
                                       "VAR_GLOBAL RETAIN b, c : REAL; END_VAR;\n"
                                       "VAR_GLOBAL NON_RETAIN d AT %IX0.0 : BOOL; END_VAR\n"
                                       "VAR_GLOBAL CONSTANT PERSISTENT e : DT; END_VAR\n");
    REQUIRE(program.variables.size() == 5);
    CHECK(program.variables[0].is_constant);
    CHECK_FALSE(program.variables[0].is_retained);
    CHECK(program.variables[1].is_retained);
    CHECK(program.variables[2].name == "c");
    CHECK(program.variables[2].is_retained);
    CHECK(program.variables[2].place.line == 2);
    CHECK(program.variables[2].place.column == 22);
    CHECK_FALSE(program.variables[3].is_retained);
    CHECK(program.variables[3].address == "%IX0.0");
    CHECK(program.variables[4].is_constant);
    CHECK(program.variables[4].is_retained);
    CHECK(program.variables[4].type.elementary == ElementaryType::DateAndTime);
    for (const char* address :
         {"%MW10", "%q*", "%ID1.2.3", "%M0", "%FX0", "%d100", "%W1F", "%J1\\X0", "%U3E0\\HG5"}) {
        CHECK(variable_of("x AT " + std::string{address} + " : WORD;").address == address);
    }
}

TEST_CASE("Network Publish is an attribute before or in a declaration (3-3-1)")
{
    CHECK(published_as("") == NetworkPublish::Hidden);
    CHECK(published_as("{attribute 'publish' := 'none'}") == NetworkPublish::Hidden);
    CHECK(published_as("{attribute 'publish' := 'Do not publish'}") == NetworkPublish::Hidden);
    CHECK(published_as("{attribute 'publish' := 'publish only'}") == NetworkPublish::PublishOnly);
    CHECK(published_as("{ATTRIBUTE 'Publish' := \"public_only\"}") == NetworkPublish::PublishOnly);
    CHECK(published_as("{publish := 'PublishOnly'}") == NetworkPublish::PublishOnly);
    CHECK(published_as("{publish:=input}") == NetworkPublish::Input);
    CHECK(published_as("{attribute publish := 'output'}") == NetworkPublish::Output);
    CHECK(published_as("{attribute 'OPC.UA.DA' := '1'}") == NetworkPublish::PublishOnly);
    CHECK(published_as("{attribute 'OPC.UA.DA' := '0'}") == NetworkPublish::Hidden);
    CHECK(published_as("{attribute 'other' := 'output'} {region}") == NetworkPublish::Hidden);
    CHECK(variable_of("x : INT := 1 {publish := 'input'};").publish == NetworkPublish::Input);
}

TEST_CASE("Network Publish of a block is that of variables that have none (3-3-1)")
{
    const Program program = program_of("{attribute 'publish' := 'output'} VAR_GLOBAL\n"
                                       "a : INT;\n"
                                       "{publish := 'none'} b : INT; c, d : INT;\n"
                                       "END_VAR VAR_GLOBAL e : INT; END_VAR");
    REQUIRE(program.variables.size() == 5);
    CHECK(program.variables[0].publish == NetworkPublish::Output);
    CHECK(program.variables[1].publish == NetworkPublish::Hidden);
    CHECK(program.variables[2].publish == NetworkPublish::Output);
    CHECK(program.variables[3].publish == NetworkPublish::Output);
    CHECK(program.variables[4].publish == NetworkPublish::Hidden);
}

TEST_CASE("Comments behind a declaration are kept, others are not (6-2-2)")
{
    const Program program = program_of("(* of (* the *) file *) /* a /* b */ c */\n"
                                       "VAR_GLOBAL (* of the block *)\n"
                                       "  // of nothing\n"
                                       "  a : INT; // the first\n"
                                       "  b : INT; (* the\n second *) (* more *)\n"
                                       "  c (* inside *) : INT;\n"
                                       "  (* before *) d : INT; /**/ // empty\n"
                                       "END_VAR // at the end");
    REQUIRE(program.variables.size() == 4);
    CHECK(program.variables[0].comment == "the first");
    CHECK(program.variables[1].comment == "the\n second");
    CHECK(program.variables[2].comment.empty());
    CHECK(program.variables[3].comment.empty());
    CHECK(program.variables[3].place.line == 8);
    CHECK(program.variables[3].place.column == 16);
}

TEST_CASE("Tasks and programs of a configuration are read (6-2-1)")
{
    const Program program =
        program_of("CONFIGURATION Machine\n"
                   "  VAR_GLOBAL a : INT; END_VAR\n"
                   "  RESOURCE Cpu ON Nx {r}\n"
                   "    VAR_GLOBAL b : INT; END_VAR\n"
                   "    TASK Primary(INTERVAL := T#1ms, PRIORITY := 4);\n"
                   "    TASK Event(SINGLE := a, PRIORITY := 8);\n"
                   "    PROGRAM Main WITH Primary : MainProgram (x := a, y => (b));\n"
                   "    PROGRAM RETAIN Idle : IdleProgram;\n"
                   "  END_RESOURCE\n"
                   "END_CONFIGURATION");
    CHECK(program.variables.size() == 2);
    REQUIRE(program.tasks.size() == 2);
    CHECK(program.tasks[0].name == "Primary");
    CHECK(program.tasks[0].interval == "T#1ms");
    CHECK(program.tasks[0].priority == 4);
    CHECK(program.tasks[1].interval.empty());
    REQUIRE(program.instances.size() == 2);
    CHECK(program.instances[0].type_name == "MainProgram");
    CHECK(program.instances[0].task == "Primary");
    CHECK(program.instances[1].task.empty());
}

TEST_CASE("Names of other scripts and byte order marks are read (6-2-2)")
{
    const Program program = program_of("\xEF\xBB\xBFVAR_GLOBAL \xE6\xB8\xA9\xE5\xBA\xA6 : INT;"
                                       " On, Task, Bit : BOOL; END_VAR");
    REQUIRE(program.variables.size() == 4);
    CHECK(program.variables[0].name == "\xE6\xB8\xA9\xE5\xBA\xA6");
    CHECK(program.variables[0].place.column == 12);
    CHECK(program.variables[1].place.column == 22);
    CHECK(program_of("").variables.empty());
    CHECK(program_of(" ; (* nothing *) {pragma} ").types.empty());
}

TEST_CASE("A text of 100,000 variables is read (6-2-2)")
{
    std::string text = "VAR_GLOBAL\n";
    for (int i = 0; i < 100'000; ++i) {
        text += "  Variable" + std::to_string(i) + " : DINT := 16#10; // one of many\n";
    }
    const Program program = program_of(text + "END_VAR\n");
    REQUIRE(program.variables.size() == 100'000);
    CHECK(program.variables.back().name == "Variable99999");
    CHECK(program.variables.back().place.line == 100'001);
}

} // namespace declarations_test
