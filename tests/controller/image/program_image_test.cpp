#include <catch2/catch.hpp>

#include <numeric>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program_image.hpp>
#include <busbar/core/extension_object.hpp>

namespace program_image_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

TypeUse of(ElementaryType type)
{
    return {.elementary = type};
}

TypeUse of(std::string type)
{
    return {.type_name = std::move(type)};
}

TypeUse array(TypeUse type, std::vector<Bounds> bounds)
{
    type.dimensions = std::move(bounds);
    return type;
}

InitialValue initial(Variant value, std::uint32_t repeat = 1)
{
    return {.repeat = repeat, .value = std::move(value)};
}

InitialValue list(std::vector<InitialValue> parts, std::uint32_t repeat = 1)
{
    return {.repeat = repeat, .parts = std::move(parts)};
}

InitialValue member(std::string name, InitialValue value)
{
    value.member = std::move(name);
    return value;
}

DerivedType mode()
{
    return {.name = "Mode",
            .kind = DerivedType::Kind::Enumeration,
            .enumerators = {{"Off", 3}, {"On", 5}}};
}

DerivedType axis()
{
    DerivedType type{.name = "Axis"};
    type.members = {
        {.name = "Mode", .type = of("Mode")},
        {.name = "Limits",
         .type = array(of(ElementaryType::Real), {{1, 3}}),
         .initial = list({initial(1.5), initial(std::int64_t{2}, 2)})},
        {.name = "Name", .type = {.elementary = ElementaryType::String, .string_length = 8}}};
    return type;
}

const auto encoding_of = [](const DerivedType& type) { return NodeId{2, String{type.name}}; };

Configured<ProgramImage> image_of(const Program& program)
{
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);
    std::vector<std::size_t> all(program.variables.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return ProgramImage::create(*types, all, encoding_of);
}

/// What one variable begins with.
Variant begins_with(GlobalVariable variable, std::vector<DerivedType> types = {mode(), axis()})
{
    Program program;
    program.types = std::move(types);
    program.variables = {std::move(variable)};
    const auto made = image_of(program);
    INFO((made ? "" : text(made.error())));
    REQUIRE(made);
    return made->image()->memory().load(0);
}

std::string refusal_of(GlobalVariable variable, std::vector<DerivedType> types = {mode(), axis()})
{
    Program program;
    program.types = std::move(types);
    program.variables = {std::move(variable)};
    const auto made = image_of(program);
    return made ? "" : text(made.error());
}

} // namespace

TEST_CASE("Each data type of the controller is one of OPC UA (6-2-2)")
{
    const auto check = [](BuiltInType expected, std::vector<ElementaryType> types) {
        for (const ElementaryType type : types) {
            INFO(name(type));
            CHECK(controller::built_in_type_of(type) == expected);
        }
    };
    using E = ElementaryType;
    check(BuiltInType::Boolean, {E::Bool});
    check(BuiltInType::SByte, {E::Sint});
    check(BuiltInType::Byte, {E::Usint, E::Byte});
    check(BuiltInType::Int16, {E::Int});
    check(BuiltInType::UInt16, {E::Uint, E::Word});
    check(BuiltInType::Int32, {E::Dint});
    check(BuiltInType::UInt32, {E::Udint, E::Dword});
    check(BuiltInType::Int64, {E::Lint});
    check(BuiltInType::UInt64, {E::Ulint, E::Lword});
    check(BuiltInType::Float, {E::Real});
    check(BuiltInType::Double, {E::Time, E::Lreal});
    check(BuiltInType::String, {E::String});
    check(BuiltInType::DateTime, {E::DateAndTime, E::Date, E::TimeOfDay});
    CHECK(begins_with({.name = "e", .type = of("Mode")}).type() == BuiltInType::Int32);
}

TEST_CASE("Variables get their handles in the order of publishing (6-2-2)")
{
    Program program;
    program.variables = {{.name = "a", .type = of(ElementaryType::Int)},
                         {.name = "b", .type = of(ElementaryType::Bool)},
                         {.name = "c", .type = array(of(ElementaryType::Lreal), {{0, 1}, {1, 3}})}};
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);
    const std::vector<std::size_t> chosen{2, 0};
    const auto made = ProgramImage::create(*types, chosen, encoding_of);
    REQUIRE(made);
    CHECK(made->variables().size() == 2);
    CHECK(made->variables()[0] == 2);
    CHECK(made->image()->layout().size() == 2);
    CHECK(made->image()->layout()[0].dimensions == std::vector<std::uint32_t>{2, 3});
    CHECK(made->image()->layout()[1].type == BuiltInType::Int16);
}

TEST_CASE("A variable without initial value begins as its type says (6-2-2)")
{
    CHECK(begins_with({.name = "n", .type = of(ElementaryType::Int)}) == Variant{std::int16_t{0}});
    CHECK(begins_with({.name = "s", .type = of(ElementaryType::String)}) == Variant{String{""}});
    CHECK(begins_with({.name = "e", .type = of("mode")}) == Variant{3});
    const DateTime first_day = DateTime::from_unix_seconds(0);
    CHECK(begins_with({.name = "d", .type = of(ElementaryType::Date)}) == Variant{first_day});
    CHECK(begins_with({.name = "t", .type = of(ElementaryType::DateAndTime)}) ==
          Variant{first_day});
    CHECK(begins_with({.name = "d", .type = of(ElementaryType::Ldate)}) == Variant{first_day});
    CHECK(begins_with({.name = "t", .type = of(ElementaryType::LdateAndTime)}) ==
          Variant{first_day});
    CHECK(begins_with({.name = "o", .type = of(ElementaryType::TimeOfDay)}) == Variant{DateTime{}});
    TypeUse narrow = of(ElementaryType::Int);
    narrow.subrange = Bounds{4, 9};
    CHECK(begins_with({.name = "r", .type = array(narrow, {{0, 1}})}) ==
          Variant{Array<std::int16_t>{4, 4}});
    DerivedType percent{.name = "Percent", .kind = DerivedType::Kind::Alias};
    percent.alias = of(ElementaryType::Usint);
    percent.initial = initial(std::int64_t{50});
    CHECK(begins_with({.name = "p", .type = of("Percent")}, {percent}) ==
          Variant{std::uint8_t{50}});
    CHECK(begins_with({.name = "p", .type = of("Percent"), .initial = initial(std::int64_t{7})},
                      {percent}) == Variant{std::uint8_t{7}});
}

TEST_CASE("Initial values of every kind (6-2-2)")
{
    const auto value = [](ElementaryType type, Variant declared) {
        return begins_with(
            {.name = "v", .type = of(type), .initial = initial(std::move(declared))});
    };
    CHECK(value(ElementaryType::Bool, true) == Variant{true});
    CHECK(value(ElementaryType::Bool, std::int64_t{1}) == Variant{true});
    CHECK(value(ElementaryType::Sint, std::int64_t{-128}) == Variant{std::int8_t{-128}});
    CHECK(value(ElementaryType::Lword, UINT64_MAX) == Variant{UINT64_MAX});
    CHECK(value(ElementaryType::Real, 0.5) == Variant{0.5F});
    CHECK(value(ElementaryType::Lreal, std::int64_t{3}) == Variant{3.0});
    CHECK(value(ElementaryType::Time, 1500.0) == Variant{1500.0});
    CHECK(value(ElementaryType::Date, DateTime{42}) == Variant{DateTime{42}});
    CHECK(value(ElementaryType::String, String{"pump"}) == Variant{"pump"});
    CHECK(begins_with({.name = "e", .type = of("Mode"), .initial = initial("ON")}) == Variant{5});
    CHECK(begins_with({.name = "a",
                       .type = array(of(ElementaryType::Int), {{0, 1}, {0, 2}}),
                       .initial = list({initial(std::int64_t{1}), initial(std::int64_t{2}, 3)})}) ==
          Variant::matrix(Array<std::int16_t>{1, 2, 2, 2, 0, 0}, Array<std::uint32_t>{2, 3}));
    const InitialValue three = list({initial(std::int64_t{1}), initial(std::int64_t{2}, 2)});
    CHECK(begins_with({.name = "a",
                       .type = array(of(ElementaryType::Int), {{0, 1}, {0, 2}}),
                       .initial = list({three, three})}) ==
          Variant::matrix(Array<std::int16_t>{1, 2, 2, 1, 2, 2}, Array<std::uint32_t>{2, 3}));
    // A row that is short, or has no value, does not move the next one.
    CHECK(begins_with({.name = "a",
                       .type = array(of(ElementaryType::Int), {{0, 2}, {0, 2}}),
                       .initial = list({list({initial(std::int64_t{7})}), InitialValue{},
                                        list({initial(std::int64_t{8})})})}) ==
          Variant::matrix(Array<std::int16_t>{7, 0, 0, 0, 0, 0, 8, 0, 0},
                          Array<std::uint32_t>{3, 3}));
}

TEST_CASE("Elements of an array begin as their type says (6-2-2)")
{
    const auto matrix = [](Array<std::int16_t> values) {
        return Variant::matrix(std::move(values), Array<std::uint32_t>{3, 2});
    };
    DerivedType started = mode();
    started.initial = initial("On");
    CHECK(begins_with({.name = "a", .type = array(of("Mode"), {{0, 3}})}, {started}) ==
          Variant{Array<std::int32_t>{5, 5, 5, 5}});
    DerivedType percent{.name = "Percent", .kind = DerivedType::Kind::Alias};
    percent.alias = of(ElementaryType::Int);
    percent.alias.subrange = Bounds{10, 100};
    percent.initial = initial(std::int64_t{50});
    CHECK(begins_with({.name = "a", .type = array(of("Percent"), {{0, 2}, {0, 1}})}, {percent}) ==
          matrix({50, 50, 50, 50, 50, 50}));
    DerivedType row{.name = "Row", .kind = DerivedType::Kind::Alias};
    row.alias = array(of(ElementaryType::Int), {{0, 1}});
    row.initial = list({initial(std::int64_t{1}), initial(std::int64_t{2})});
    GlobalVariable rows{.name = "m", .type = array(of("Row"), {{0, 2}})};
    CHECK(begins_with(rows, {row}) == matrix({1, 2, 1, 2, 1, 2}));
    rows.initial = list({list({initial(std::int64_t{7})}), list({initial(std::int64_t{8})})});
    CHECK(begins_with(rows, {row}) == matrix({7, 2, 8, 2, 1, 2}));
    DerivedType pair{.name = "Pair"};
    pair.members = {{.name = "A", .type = of(ElementaryType::Int)},
                    {.name = "B", .type = of(ElementaryType::Int)}};
    pair.initial = list({member("B", initial(std::int64_t{5}))});
    Program program;
    program.types = {pair};
    program.variables = {{.name = "pairs", .type = array(of("Pair"), {{0, 1}})}};
    const auto made = image_of(program);
    REQUIRE(made);
    for (const std::uint32_t i : {0U, 1U}) {
        CHECK(made->image()->memory().structure(0, i).value<std::int16_t>(0) == 0);
        CHECK(made->image()->memory().structure(0, i).value<std::int16_t>(1) == 5);
    }
}

TEST_CASE("What a type's short list leaves out begins as its elements' type says")
{
    const auto begins = [](const std::string& types, const std::string& variable) {
        const auto program = read_declarations(
            "TYPE " + types + " END_TYPE\nVAR_GLOBAL x : " + variable + "; END_VAR", "i.st");
        REQUIRE(program);
        const auto made = image_of(*program);
        INFO((made ? "" : text(made.error())));
        REQUIRE(made);
        return made->image()->memory().load(0);
    };
    using Ints = Array<std::int16_t>;
    const std::string level = "Level : INT := 7; ";
    CHECK(begins(level + "Row : ARRAY[0..3] OF Level := [1, 2];", "Row") ==
          Variant{Ints{1, 2, 7, 7}});
    CHECK(begins(level + "Row : ARRAY[0..3] OF Level := [1(), 2(3)];", "Row") ==
          Variant{Ints{7, 3, 3, 7}});
    CHECK(begins(level + "Row : ARRAY[0..3] OF Level := [1];", "Row := [3()]") ==
          Variant{Ints{1, 7, 7, 7}});
    CHECK(begins(level + "Row : ARRAY[0..2] OF Level := [1];", "ARRAY[0..1] OF Row := [[5, 6]]") ==
          Variant::matrix(Ints{5, 6, 7, 1, 7, 7}, Array<std::uint32_t>{2, 3}));
    CHECK(begins(level + "Row : ARRAY[0..1] OF Level := [1]; Rows : ARRAY[0..2] OF Row := [[8]];",
                 "Rows") == Variant::matrix(Ints{8, 7, 1, 7, 1, 7}, Array<std::uint32_t>{3, 2}));
    CHECK(begins(level + "High : Level := 9; Row : ARRAY[0..1] OF High := [1];", "Row") ==
          Variant{Ints{1, 9}});
    CHECK(begins("Mode : (Off, On) := On; Row : ARRAY[0..2] OF Mode := [Off];", "Row") ==
          Variant{Array<std::int32_t>{0, 1, 1}});
    CHECK(begins("Name : STRING[5] := 'none'; Row : ARRAY[0..1] OF Name := ['a'];", "Row") ==
          Variant{Array<String>{"a", "none"}});
}

TEST_CASE("A type's initial value leaves the other members as the structure's type says")
{
    const auto program = read_declarations(
        "TYPE Pair : STRUCT A : INT := 1; B : INT := 2; C : INT := 3; END_STRUCT := (B := 4);\n"
        "Other : Pair := (A := 5);\n"
        "Row : ARRAY[0..1] OF Other := [(C := 6)]; END_TYPE\n"
        "VAR_GLOBAL one : Other; row : Row; END_VAR",
        "i.st");
    REQUIRE(program);
    const auto made = image_of(*program);
    REQUIRE(made);
    const auto numbers = [&](std::uint32_t variable, std::uint32_t element) {
        const auto view = made->image()->memory().structure(variable, element);
        return std::vector{view.value<std::int16_t>(0), view.value<std::int16_t>(1),
                           view.value<std::int16_t>(2)};
    };
    CHECK(numbers(0, 0) == std::vector<std::int16_t>{5, 4, 3});
    CHECK(numbers(1, 0) == std::vector<std::int16_t>{5, 4, 6});
    CHECK(numbers(1, 1) == std::vector<std::int16_t>{5, 4, 3});
}

TEST_CASE("Initial values of structures, member by member (6-2-2)")
{
    Program program;
    program.types = {mode(), axis()};
    program.variables = {
        {.name = "axes",
         .type = array(of("Axis"), {{0, 2}}),
         .initial = list(
             {InitialValue{}, list({member("name", initial("left")), member("Mode", initial("On")),
                                    member("limits", list({initial(9.0)}))})})}};
    const auto made = image_of(program);
    REQUIRE(made);
    server::ImageMemory& memory = made->image()->memory();
    for (const std::uint32_t other : {0U, 2U}) {
        const auto view = memory.structure(0, other);
        CHECK(view.value<std::int32_t>(0) == 3);
        CHECK(view.values<float>(1)[0] == 1.5F);
        CHECK(view.values<float>(1)[2] == 2.0F);
        CHECK(view.text(2) == "");
    }
    const auto left = memory.structure(0, 1);
    CHECK(left.value<std::int32_t>(0) == 5);
    CHECK(left.values<float>(1)[0] == 9.0F);
    CHECK(left.values<float>(1)[1] == 2.0F); // as the member begins
    CHECK(left.text(2) == "left");
    const Variant all = memory.load(0);
    CHECK((*all.array_if<ExtensionObject>())[0].encoding_id() == NodeId{2, "Axis"});
}

TEST_CASE("A subrange holds for what is written, wherever it is declared (6-2-2)")
{
    Program program;
    const TypeUse gear{.elementary = ElementaryType::Int, .subrange = Bounds{1, 5}};
    program.types = {{.name = "Gear", .kind = DerivedType::Kind::Alias, .alias = gear},
                     {.name = "Drive", .members = {{.name = "Gear", .type = of("Gear")}}}};
    program.variables = {{.name = "own", .type = gear},
                         {.name = "named", .type = of("Gear")},
                         {.name = "gears", .type = array(of("Gear"), {{0, 1}})},
                         {.name = "drive", .type = of("Drive")},
                         {.name = "any", .type = of(ElementaryType::Int)}};
    const auto made = image_of(program);
    REQUIRE(made);
    server::ImageMemory& memory = made->image()->memory();
    for (const std::uint32_t handle : {0U, 1U}) {
        CHECK(memory.store(handle, std::int16_t{5}) == status::Good);
        CHECK(memory.store(handle, std::int16_t{6}) == status::Bad_OutOfRange);
    }
    CHECK(memory.store(2, Array<std::int16_t>{5, 1}) == status::Good);
    CHECK(memory.store(2, Array<std::int16_t>{5, 0}) == status::Bad_OutOfRange);
    const auto drive = [](int value) {
        return ExtensionObject::from_binary(
            NodeId{2, "Drive"},
            ByteString{std::vector<std::byte>{static_cast<std::byte>(value), std::byte{0}}});
    };
    CHECK(memory.store(3, drive(5)) == status::Good);
    CHECK(memory.store(3, drive(6)) == status::Bad_OutOfRange);
    CHECK(memory.store(4, std::int16_t{6}) == status::Good);
}

TEST_CASE("What an image cannot have is refused, with its place (6-2-2)")
{
    DerivedType either = axis();
    either.name = "Either";
    either.kind = DerivedType::Kind::Union;
    DerivedType outer{.name = "Outer"};
    outer.members = {{.name = "Inner", .type = of("Either")}};
    CHECK(refusal_of({.name = "u", .type = of("Outer")}, {mode(), either, outer}) ==
          "variables[0] (u).Inner: is a union, which has no place in a process image");
    const auto refused = [](ElementaryType type, InitialValue value) {
        return refusal_of({.name = "v", .type = of(type), .initial = std::move(value)});
    };
    using E = ElementaryType;
    CHECK(refused(E::Sint, initial(std::int64_t{128})) ==
          "variables[0] (v): has 128, expected a value of SINT");
    CHECK(refused(E::Uint, initial(std::int64_t{-1})) != "");
    CHECK(refused(E::Int, initial(1.5)) != "");
    CHECK(refused(E::Bool, initial(std::int64_t{2})) != "");
    CHECK(refused(E::Real, initial(1e300)) != "");
    CHECK(refused(E::Date, initial(std::int64_t{1})) != "");
    CHECK(refused(E::Int, initial("On")) != "");
    CHECK(refused(E::Int, list({initial(std::int64_t{1})})) ==
          "variables[0] (v): has several values, expected one");
    GlobalVariable variable{.name = "v", .type = of("Mode"), .initial = initial("Idle")};
    variable.place = {4, 2};
    CHECK(refusal_of(variable) ==
          "4:2: variables[0] (v): has a text of 4 bytes, expected the name of a value of Mode");
    TypeUse narrow = of(E::Int);
    narrow.subrange = Bounds{0, 10};
    CHECK(refusal_of({.name = "v", .type = narrow, .initial = initial(std::int64_t{11})}) ==
          "variables[0] (v): has 11, expected a value of INT (0..10)");
    CHECK(refusal_of({.name = "v",
                      .type = {.elementary = E::String, .string_length = 3},
                      .initial = initial("long")}) ==
          "variables[0] (v): has a text of 4 bytes, expected a value of STRING[3]");
}

TEST_CASE("Lists of initial values have to fit (6-2-2)")
{
    GlobalVariable variable{.name = "v", .type = array(of(ElementaryType::Int), {{1, 3}})};
    variable.initial = list({initial(std::int64_t{1}, UINT32_MAX)});
    CHECK(refusal_of(variable) ==
          "variables[0] (v): has a list of more than the 3 elements that there are");
    variable.initial = list({list({list({initial(std::int64_t{1}, 2)}, 2)}, UINT32_MAX)});
    CHECK(refusal_of(variable) != "");
    variable.initial = list({initial(std::int64_t{1}), initial("x")});
    CHECK(refusal_of(variable) ==
          "variables[0] (v)[1]: has a text of 1 bytes, expected a value of INT");
    variable.initial = initial(std::int64_t{1});
    CHECK(refusal_of(variable) == "variables[0] (v): has no list, expected one as [1, 2]");
    variable.type = of("Axis");
    CHECK(refusal_of(variable) ==
          "variables[0] (v): has no members, expected those of Axis as (X := 1)");
    variable.initial = list({member("Speed", initial(1.0))});
    CHECK(refusal_of(variable) == "variables[0] (v).Speed: is not a member of Axis");
    variable.initial = list({member("Limits", list({initial(1.0), initial(true)}))});
    CHECK(refusal_of(variable) == "variables[0] (v).Limits[1]: has TRUE, expected a value of REAL");
}

TEST_CASE("Variables take in the image what ProgramTypes says of it")
{
    using E = ElementaryType;
    const auto text = [](std::uint32_t length) {
        return TypeUse{.elementary = E::String, .string_length = length};
    };
    DerivedType mixed{.name = "Mixed"};
    mixed.members = {{.name = "Flag", .type = of(E::Bool)},
                     {.name = "Name", .type = text(6)},
                     {.name = "Flags", .type = array(of(E::Bool), {{0, 16}})},
                     {.name = "Axes", .type = array(of("Axis"), {{1, 3}})},
                     {.name = "End", .type = of(E::Bool)}};
    Program program;
    program.types = {mode(), axis(), mixed};
    for (std::size_t i = 0; i < static_cast<std::size_t>(E::String); ++i) {
        program.variables.push_back(
            {.name = "v" + std::to_string(i), .type = of(static_cast<E>(i))});
    }
    program.variables.push_back({.name = "text", .type = text(9)});
    program.variables.push_back({.name = "texts", .type = array(text(8), {{0, 4}})});
    program.variables.push_back({.name = "flags", .type = array(of(E::Bool), {{0, 4}, {0, 6}})});
    program.variables.push_back({.name = "mode", .type = array(of("Mode"), {{0, 2}})});
    program.variables.push_back({.name = "mixed", .type = array(of("Mixed"), {{0, 4}})});
    const auto types = ProgramTypes::create(program);
    const auto made = image_of(program);
    REQUIRE(types);
    REQUIRE(made);
    const server::ImageLayout& layout = made->image()->memory().layout();
    for (std::uint32_t i = 0; i < program.variables.size(); ++i) {
        INFO(program.variables[i].name);
        CHECK(types->size_of(program.variables[i].type, ValueMemory::Image) == layout[i].bytes());
    }
}

} // namespace program_image_test
