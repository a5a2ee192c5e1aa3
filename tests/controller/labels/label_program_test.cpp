#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include "controller/labels/label_finder.hpp"
#include "label_bench.hpp"

namespace label_program_test {

// Which labels a program's variables are, and how their values lie in a request.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

const std::string types = R"(
    TYPE
        Mode : (Off, On := 7);
        Text16 : ARRAY [0..16] OF UTF16_UNIT;
        Inner : STRUCT Level : REAL; Grid : ARRAY [0..1, 1..3] OF INT; Name : STRING[5]; END_STRUCT;
        Station : STRUCT Count : DINT; Parts : ARRAY [0..2] OF Inner; Delay : TIMER;
            Label : Text16; END_STRUCT;
        Either : UNION A : INT; B : REAL; END_UNION;
        Holder : STRUCT Plain : INT; Choice : Either; END_STRUCT;
    END_TYPE
)";

const std::string variables = R"(
    B : BOOL; I : INT; U : UINT; W : WORD; D : DINT; Ud : UDINT; Dw : DWORD; R : REAL; L : LREAL;
    T : TIME; S : STRING[10]; M : Mode; Title : Text16;
    Titles : ARRAY [1..2, 0..8] OF UTF16_UNIT; Unit : UTF16_UNIT;
    A : ARRAY [5..9] OF INT; Cube : ARRAY [0..1, 0..2, 0..3] OF DINT;
    Four : ARRAY [0..1, 0..1, 0..1, 0..1] OF INT; Below : ARRAY [-1..1] OF INT;
    St : Station; Sts : ARRAY [1..4] OF Station;
    Tm : TIMER; Rt : RETENTIVETIMER; Lt : LTIMER; Lrt : LRETENTIVETIMER; Ct : COUNTER;
    Lc : LCOUNTER; Tms : ARRAY [0..3, 0..1] OF TIMER;
    Si : SINT; Li : LINT; By : BYTE; Da : DATE; E : Either; H : Holder;
    {attribute 'publish' := 'none'} Hidden : INT;
    AtOutput : BOOL; AtIndex : INT; AtRelay : BOOL; AtStation : Station; AtTimer : TIMER;
    END_VAR {attribute 'publish' := 'public'} VAR_GLOBAL CONSTANT Fixed : INT := 3;
)";

struct Device {
    std::string_view variable;
    std::string_view address;
};

/// The addresses of a PLC's own, which declarations do not have.
constexpr std::array devices{Device{"AtOutput", "FX0"}, Device{"AtIndex", "Z3"},
                             Device{"AtRelay", "SM8"}, Device{"AtStation", "D0"},
                             Device{"AtTimer", "TS0"}};

Program all_kinds()
{
    Program program = program_of(variables, types);
    for (const Device& device : devices) {
        std::ranges::find(program.variables, device.variable, &GlobalVariable::name)->address =
            device.address;
    }
    return program;
}

} // namespace

TEST_CASE("a name stands for a label with the type of its variable (8.2)")
{
    struct Row {
        std::string name;
        LabelKind kind;
    };
    using enum LabelType;
    const auto row = GENERATE(values<Row>({
        {"B", {Bit}},
        {"I", {Word}},
        {"U", {UnsignedWord}},
        {"W", {UnsignedWord}},
        {"D", {DoubleWord}},
        {"Ud", {UnsignedDoubleWord}},
        {"Dw", {UnsignedDoubleWord}},
        {"R", {Float}},
        {"L", {Double}},
        {"T", {Time}},
        {"S", {String, TimerPart::None, 10}},
        {"M", {DoubleWord}},
        {"Title", {UnicodeString, TimerPart::None, 16}},
        {"Titles[2]", {UnicodeString, TimerPart::None, 8}},
        {"Unit", {UnsignedWord}},
        {"a[5]", {Word}},
        {"Cube[1,2,3]", {DoubleWord}},
        {"Cube[1][2][3]", {DoubleWord}},
        {"Below[0]", {Word}},
        {"St.count", {DoubleWord}},
        {"ST.PARTS[2].LEVEL", {Float}},
        {"St.Parts[0].Grid[1,3]", {Word}},
        {"Sts[4].Parts[2].Name", {String, TimerPart::None, 5}},
        {"Sts[1].Label", {UnicodeString, TimerPart::None, 16}},
        {"Sts[1].Delay.N", {Timer, TimerPart::Current}},
        {"Tm.S", {Timer, TimerPart::Contact}},
        {"Tm.c", {Timer, TimerPart::Coil}},
        {"Tm.N", {Timer, TimerPart::Current}},
        {"Rt.N", {RetentiveTimer, TimerPart::Current}},
        {"Lt.N", {LongTimer, TimerPart::Current}},
        {"Lrt.S", {LongRetentiveTimer, TimerPart::Contact}},
        {"Ct.N", {Counter, TimerPart::Current}},
        {"Lc.N", {LongCounter, TimerPart::Current}},
        {"Tms[3,1].C", {Timer, TimerPart::Coil}},
        {"AtTimer.S", {Timer, TimerPart::Contact}},
    }));
    LabelBench bench{all_kinds()};
    const ResolvedLabel label = bench.resolve(row.name);
    INFO(row.name);
    REQUIRE(label.error == LabelError::None);
    CHECK(label.kind == row.kind);
    CHECK_FALSE(label.is_unsampled_device);
}

TEST_CASE("a name that stands for no label is told apart by the reason (8.3)")
{
    struct Row {
        std::string name;
        LabelError error;
    };
    using enum LabelError;
    const auto row = GENERATE(values<Row>({
        {"Nothing", Unknown},      {"St.Nothing", Unknown},
        {"I.Member", Unknown},     {"I[0]", Unknown},
        {"A[4]", Unknown},         {"A[10]", Unknown},
        {"A[5,5]", Unknown},       {"Cube[1,3,0]", Unknown},
        {"Tm.X", Unknown},         {"Tm.N[0]", Unknown},
        {"Tm.N.N", Unknown},       {"A", NotAName},
        {"Cube[0]", NotAName},     {"Cube[0,1]", NotAName},
        {"Four[0,0,0]", NotAName}, {"St", NotAName},
        {"Sts[1]", NotAName},      {"St.Parts", NotAName},
        {"St.Parts[0]", NotAName}, {"Tm", NotAName},
        {"Tms[0,0]", NotAName},    {"Title[0]", NotAName},
        {"Titles", NotAName},      {"I.1", NotAName},
        {"K4I", NotAName},         {"", NotAName},
        {"Hidden", NotAccessible}, {"AtStation.Count", NotAccessible},
        {"Fixed", Constant},       {"Si", UnsupportedType},
        {"Li", UnsupportedType},   {"By", UnsupportedType},
        {"Da", UnsupportedType},   {"E", UnsupportedType},
        {"E.A", UnsupportedType},  {"H.Plain", UnsupportedType},
    }));
    LabelBench bench{all_kinds()};
    INFO(row.name);
    CHECK(bench.resolve(row.name).error == row.error);
}

TEST_CASE("each value has a place of its own, which all ways to write its name share")
{
    LabelBench bench{all_kinds()};
    const auto labels = bench.resolve(
        {"Cube[0,0,0]", "Cube[0,0,1]", "cube[0][0][1]", "Sts[1].Count", "Sts[2].Count"});
    CHECK(labels[1].address == labels[2].address);
    CHECK(labels[0].address != labels[1].address);
    CHECK(labels[3].address != labels[4].address);
    CHECK(bench.resolve("CUBE[0,0,1]").address == labels[1].address);
}

TEST_CASE("elements lie where the PLC's program has them")
{
    LabelBench bench{all_kinds()};
    const auto program = bench.labels->program();
    const auto element = [&](std::string_view variable, std::size_t index) {
        return bench.labels->memory().values<std::int32_t>(
            program->handle_of(*program->variable(variable)).value())[index];
    };
    static_cast<void>(bench.write("Cube[1,2,3]", wire(std::int32_t{9})));
    static_cast<void>(bench.write("Cube[0,1,0]", wire(std::int32_t{8})));
    CHECK(element("Cube", 23) == 9);
    CHECK(element("Cube", 4) == 8);
    static_cast<void>(bench.write("A[5]", wire(std::int16_t{7})));
    static_cast<void>(bench.write("A[9]", wire(std::int16_t{6})));
    const auto row = bench.labels->memory().values<std::int16_t>(
        program->handle_of(*program->variable("A")).value());
    CHECK(row.front() == 7);
    CHECK(row.back() == 6);
}

TEST_CASE("values are little endian in a request, and where the PLC's program has them")
{
    struct Row {
        std::string name;
        std::vector<std::byte> bytes;
    };
    const std::string text = "abc";
    const auto row = GENERATE_COPY(values<Row>({
        {"B", wire(true)},
        {"I", wire(std::int16_t{-2})},
        {"U", wire(std::uint16_t{0xFEDC})},
        {"D", wire(std::int32_t{-70'000})},
        {"Dw", wire(0xFEDCBA98U)},
        {"R", wire(1.5F)},
        {"L", wire(-1.25)},
        {"T", wire(std::int32_t{-1'500})},
        {"S", wire(std::string_view{"abc\0\0\0\0\0\0\0\0", 11})},
        {"S", wire(std::string_view{"0123456789\0", 11})},
        // Not UTF-8, and taken as it is.
        {"S", wire(std::string_view{"\x83\x65\x83\x58\x83\x67\0\0\0\0\0", 11})},
        {"Titles[1]", wire(std::string_view{"a\0\x29\x6E\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 18})},
        {"Tms[2,1].N", wire(std::uint16_t{77})},
        {"Tms[2,1].S", wire(true)},
        {"Lc.N", wire(100'000U)},
        {"Sts[3].Parts[1].Grid[1,2]", wire(std::int16_t{5})},
        {"Cube[1,2,3]", wire(std::int32_t{9})},
    }));
    LabelBench bench{all_kinds()};
    INFO(row.name);
    CHECK(bench.write(row.name, row.bytes) == LabelStatus::Done);
    CHECK(bench.read(row.name) == row.bytes);
}

TEST_CASE("what a Write has too much of is not kept")
{
    LabelBench bench{all_kinds()};
    // Without a zero at its end, and with something behind one.
    static_cast<void>(bench.write("S", wire(std::string_view{"0123456789X"})));
    CHECK(bench.read("S") == wire(std::string_view{"0123456789\0", 11}));
    static_cast<void>(bench.write("S", wire(std::string_view{"a\0bcdefghij", 11})));
    CHECK(bench.read("S") == wire(std::string_view{"a\0\0\0\0\0\0\0\0\0\0", 11}));
    static_cast<void>(bench.write("Titles[1]", std::vector<std::byte>(18, std::byte{'x'})));
    static_cast<void>(
        bench.write("Titles[1]", wire(std::string_view{"a\0\0\0c\0d\0e\0f\0g\0h\0i\0", 18})));
    CHECK(bench.read("Titles[1]") ==
          wire(std::string_view{"a\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 18}));
    static_cast<void>(bench.write("B", {std::byte{4}}));
    CHECK(bench.read("B") == wire(true));
}

TEST_CASE("a time that 32 bits of milliseconds do not have is the nearest one")
{
    LabelBench bench{all_kinds()};
    const auto as_label = [&](double milliseconds) {
        bench.variable<double>("T") = milliseconds;
        return bench.read("T");
    };
    CHECK(as_label(2.5) == wire(std::int32_t{3}));
    CHECK(as_label(1e12) == wire(std::int32_t{INT32_MAX}));
    CHECK(as_label(-1e12) == wire(std::int32_t{INT32_MIN}));
    CHECK(as_label(std::numeric_limits<double>::quiet_NaN()) == wire(std::int32_t{0}));
}

TEST_CASE("labels begin as the program declares its variables")
{
    LabelBench bench{program_of("I : INT := -3; S : STRING[4] := 'ab'; T : TIME := T#2s; "
                                "A : ARRAY [0..2] OF DINT := [7, 2(8)];")};
    CHECK(bench.read("I") == wire(std::int16_t{-3}));
    CHECK(bench.read("S") == wire(std::string_view{"ab\0\0\0", 5}));
    CHECK(bench.read("T") == wire(std::int32_t{2'000}));
    CHECK(bench.read("A[0]") == wire(std::int32_t{7}));
    CHECK(bench.read("A[2]") == wire(std::int32_t{8}));
}

TEST_CASE("a WSTRING is a label of UTF-16, which begins as it is declared (8.2)")
{
    LabelBench bench{program_of(
        "W : WSTRING[4] := \"a$6E29\"; Ws : ARRAY [1..2] OF WSTRING[3] := [2(\"$D83D$DE00\")]; "
        "N : Name; P : Part := (Name := \"x\"); E : Name := \"\"; Ps : ARRAY [0..1] OF Part;",
        "TYPE Name : WSTRING[2] := \"on\"; "
        "Part : STRUCT Id : INT := 4; Name : Name; Other : WSTRING[2] := \"o\"; END_STRUCT; "
        "END_TYPE ")};
    struct Row {
        std::string name;
        std::uint32_t length;
        std::string_view bytes;
    };
    for (const Row& row :
         {Row{"W", 4, {"a\0\x29\x6E\0\0\0\0\0\0", 10}},
          Row{"Ws[2]", 3, {"\x3D\xD8\x00\xDE\0\0\0\0", 8}}, Row{"N", 2, {"o\0n\0\0\0", 6}},
          Row{"P.Name", 2, {"x\0\0\0\0\0", 6}}, Row{"P.Other", 2, {"o\0\0\0\0\0", 6}},
          Row{"E", 2, {"\0\0\0\0\0\0", 6}}, Row{"Ps[1].Name", 2, {"o\0n\0\0\0", 6}}}) {
        INFO(row.name);
        const ResolvedLabel label = bench.resolve(row.name);
        REQUIRE(label.error == LabelError::None);
        CHECK(label.kind == LabelKind{LabelType::UnicodeString, TimerPart::None, row.length});
        CHECK(bench.read(row.name).size() == row.bytes.size());
        // What follows the first zero is of no account.
        const auto bytes = bench.read(row.name);
        const std::size_t end = row.bytes.find(std::string_view{"\0\0", 2});
        CHECK(std::vector<std::byte>(bytes.begin(),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(end)) ==
              wire(row.bytes.substr(0, end)));
    }
    CHECK(bench.write("W", wire(std::string_view{"b\0\0\0\0\0\0\0\0\0", 10})) == LabelStatus::Done);
    CHECK(bench.read("W") == wire(std::string_view{"b\0\0\0\0\0\0\0\0\0", 10}));
    CHECK(bench.resolve("P.Id").kind.type == LabelType::Word);
    const auto refused = SimulatedLabels::create(program_of("W : WSTRING[2] := \"abc\";"));
    REQUIRE_FALSE(refused);
    CHECK(text(refused.error()).find("expected a value of WSTRING[2]") != std::string::npos);
}

TEST_CASE("an array of WSTRING begins with a list of all its texts, or of lists (8.2)")
{
    LabelBench bench{
        program_of("F : ARRAY [0..2, 0..1] OF WSTRING[2] := [\"a\", 3(\"b\"), \"c\"]; "
                   "N : ARRAY [0..1, 0..1] OF WSTRING[2] := [[\"a\"], [\"b\", \"c\"]]; "
                   "R : ARRAY [0..2, 0..1, 0..1] OF WSTRING[2] := [\"a\", 10(\"b\"), \"c\"]; "
                   "Ts : ARRAY [0..2] OF Name;",
                   "TYPE Name : WSTRING[2] := \"on\"; END_TYPE ")};
    struct Row {
        std::string name;
        char first;
    };
    for (const Row& row :
         {Row{"F[0,0]", 'a'}, Row{"F[0,1]", 'b'}, Row{"F[1,0]", 'b'}, Row{"F[1,1]", 'b'},
          Row{"F[2,0]", 'c'}, Row{"F[2,1]", '\0'}, Row{"N[0,0]", 'a'}, Row{"N[0,1]", '\0'},
          Row{"N[1,0]", 'b'}, Row{"N[1,1]", 'c'}, Row{"R[0,0,0]", 'a'}, Row{"R[0,0,1]", 'b'},
          Row{"R[0,1,0]", 'b'}, Row{"R[1,1,1]", 'b'}, Row{"R[2,1,0]", 'b'}, Row{"R[2,1,1]", 'c'},
          Row{"Ts[0]", 'o'}, Row{"Ts[2]", 'o'}}) {
        INFO(row.name);
        CHECK(bench.read(row.name).at(0) == static_cast<std::byte>(row.first));
    }
}

TEST_CASE("initial values of WSTRING are 1 MiB at most, with their repetitions")
{
    const auto refusal = [](const std::string& count) {
        const auto made =
            SimulatedLabels::create(program_of("W : ARRAY [1..20000] OF WSTRING[64] := [" + count +
                                               "(\"" + std::string(64, 'x') + "\")];"));
        return made ? "" : text(made.error());
    };
    CHECK(refusal("16384") == "");
    CHECK(refusal("16385") == "WSTRING: has initial values of more than 1048576 bytes");
}

TEST_CASE("a program that cannot be is refused as others are")
{
    const auto refusal = [](Program program) {
        const auto made = SimulatedLabels::create(std::move(program));
        return made ? "" : text(made.error());
    };
    CHECK(refusal(program_of("X : Nothing;")).find("Nothing") != std::string::npos);
    CHECK(refusal(program_of("X : INT;", "TYPE Timer : STRUCT A : INT; END_STRUCT; END_TYPE "))
              .find("is also the name of another type") != std::string::npos);
    CHECK(refusal(program_of("X : INT := 100000;")).find("INT") != std::string::npos);
}

TEST_CASE("devices that cannot be sampled are those of the list (8.3)")
{
    struct Row {
        std::string_view address;
        bool is_unsampled;
    };
    const auto row = GENERATE(values<Row>({
        {"%FX0", true},      {"FY0", true},       {"%FD3", true},    {"%S1", true},
        {"%Z0", false},      {"%J1\\X0", true},   {"J1\\SW0", true}, {"%U0\\G100", true},
        {"U3E0\\G10", true}, {"U3E0\\HG0", true}, {"%fx0", true},    {"", false},
        {"%SM400", false},   {"%SD0", false},     {"%X0", false},    {"%Y0", false},
        {"%M0", false},      {"%L0", false},      {"%F0", false},    {"%V0", false},
        {"%B0", false},      {"%D0", false},      {"%W0", false},    {"%TS0", false},
        {"%LTN0", false},    {"%CC1", false},     {"%LCN0", false},  {"%STS0", false},
        {"%LSTN0", false},   {"%SB0", false},     {"%SW0", false},   {"%LZ0", false},
        {"%R0", false},      {"%ZR0", false},     {"%RD0", false},
    }));
    INFO(row.address);
    CHECK(controller::detail::is_unsampled_device(row.address) == row.is_unsampled);
}

TEST_CASE("a label at a device that cannot be sampled says so")
{
    LabelBench bench{all_kinds()};
    CHECK(bench.resolve("AtOutput").is_unsampled_device);
    CHECK_FALSE(bench.resolve("AtIndex").is_unsampled_device);
    CHECK_FALSE(bench.resolve("AtRelay").is_unsampled_device);
}

} // namespace label_program_test
