#include <catch2/catch.hpp>

#include <busbar/controller/plc.hpp>

#include "label_bench.hpp"

namespace label_change_test {

// Labels that change (SH-082679, 8.3: label-related data update), and the programs of a PLC.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

const std::string before = "Kept : INT; Retyped : INT; Gone : INT; Text : STRING[8]; "
                           "Row : ARRAY [0..3] OF Point;";
const std::string after = "Text : STRING[8]; New : INT := 3; Kept : INT := 4; Retyped : DINT; "
                          "Row : ARRAY [0..3] OF Point;";
const std::string point = "TYPE Point : STRUCT X : INT; Y : LREAL; END_STRUCT; END_TYPE ";

} // namespace

TEST_CASE("after a change of labels their old addresses answer Mismatch")
{
    LabelBench bench{program_of(before, point)};
    auto read = bench.to_read({"Kept"});
    auto write = bench.to_write({"Kept"}, wire(std::int16_t{9}));
    auto sample = bench.to_sample({"Kept"});
    REQUIRE(bench.labels->replace_program(program_of(after, point)));
    CHECK(bench.book.changes == 1);
    CHECK(bench.serve(std::move(read))->status == LabelStatus::Mismatch);
    CHECK(bench.serve(std::move(write))->status == LabelStatus::Mismatch);
    CHECK(bench.serve(std::move(sample))->status == LabelStatus::Mismatch);
    CHECK(bench.variable<std::int16_t>("Kept") == 0);
    // Once they are resolved anew, all is well.
    CHECK(bench.write("Kept", wire(std::int16_t{9})) == LabelStatus::Done);
    CHECK(bench.read("Kept") == wire(std::int16_t{9}));
}

TEST_CASE("what waits when labels change answers Mismatch, names too")
{
    LabelBench bench{program_of(before, point), {.access_unit = 1}};
    auto read = bench.to_read({"Kept", "Gone"});
    auto names = std::make_unique<LabelRequest>();
    names->kind = LabelRequest::Kind::Resolve;
    names->names = {"Kept"};
    bench.labels->start(std::move(read));
    bench.scan(); // one half of it
    bench.labels->start(std::move(names));
    REQUIRE(bench.labels->replace_program(program_of(after, point)));
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Mismatch);
    CHECK(bench.answer()->status == LabelStatus::Mismatch);
}

TEST_CASE("names are those of the new program from the change on, whether the PLC has it or not")
{
    LabelBench bench{program_of(before, point)};
    REQUIRE(bench.labels->replace_program(program_of(after, point)));
    const auto labels = bench.resolve({"Kept", "New", "Gone", "Retyped"});
    CHECK(labels[0].error == LabelError::None);
    CHECK(labels[1].error == LabelError::None);
    CHECK(labels[2].error == LabelError::Unknown);
    CHECK(labels[3].kind.type == LabelType::DoubleWord);
}

TEST_CASE("values stay where name and type do")
{
    LabelBench bench{program_of(before, point)};
    CHECK(bench.write("Kept", wire(std::int16_t{11})) == LabelStatus::Done);
    CHECK(bench.write("Retyped", wire(std::int16_t{12})) == LabelStatus::Done);
    CHECK(bench.write("Text", wire(std::string_view{"pump\0\0\0\0\0", 9})) == LabelStatus::Done);
    CHECK(bench.write("Row[3].Y", wire(2.5)) == LabelStatus::Done);
    REQUIRE(bench.labels->replace_program(program_of(after, point)));
    CHECK(bench.read("Kept") == wire(std::int16_t{11}));
    CHECK(bench.read("New") == wire(std::int16_t{3}));
    CHECK(bench.read("Retyped") == wire(std::int32_t{0}));
    CHECK(bench.read("Text") == wire(std::string_view{"pump\0\0\0\0\0", 9}));
    CHECK(bench.read("Row[3].Y") == wire(2.5));
}

TEST_CASE("values stay over changes that come between two scans")
{
    LabelBench bench{program_of("A : INT;")};
    CHECK(bench.write("A", wire(std::int16_t{1})) == LabelStatus::Done);
    REQUIRE(bench.labels->replace_program(program_of("B : INT; A : INT;")));
    // The PLC still works with the first one.
    bench.labels->memory().value<std::int16_t>(0) = 2;
    REQUIRE(bench.labels->replace_program(program_of("B : INT; C : INT; A : INT;")));
    CHECK(bench.book.changes == 2);
    CHECK(bench.read("A") == wire(std::int16_t{2}));
}

TEST_CASE("sampling ends when labels change")
{
    LabelBench bench{program_of(before, point)};
    CHECK(bench.sample({"Kept"}) == LabelStatus::Done);
    REQUIRE(bench.labels->replace_program(program_of(after, point)));
    std::vector<std::byte> bytes(2);
    DateTime time{};
    const std::uint64_t last = bench.labels->sampled(bytes, time);
    CHECK(last != 0);
    bench.scan();
    CHECK(bench.labels->sampled(bytes, time) == last);
    CHECK(bench.sample({"Kept"}) == LabelStatus::Done);
    CHECK(bench.labels->sampled(bytes, time) > last);
}

TEST_CASE("a program that is wrong changes nothing")
{
    LabelBench bench{program_of("A : INT;")};
    auto read = bench.to_read({"A"});
    CHECK_FALSE(bench.labels->replace_program(program_of("A : Nothing;")));
    CHECK(bench.book.changes == 0);
    CHECK(bench.serve(std::move(read))->status == LabelStatus::Done);
}

TEST_CASE("the programs of a PLC run on labels")
{
    LabelBench bench{program_of("Count : DINT; Cell : ARRAY [0..1] OF Point;", point)};
    const auto program = bench.labels->program();
    PlcConfig config;
    config.programs.resize(2);
    config.programs[0].target = "Count";
    config.programs[0].amplitude = 2;
    config.programs[1].target = "Cell[1].X";
    config.programs[1].amplitude = 3;
    const auto plc = Plc::create(config, program->types(), program->image());
    INFO((plc ? "" : text(plc.error())));
    REQUIRE(plc);
    auto read = bench.to_read({"Count", "Cell[1].X"});
    bench.labels->start(std::move(read));
    (*plc)->scan(DateTime{1}, Duration{});
    (*plc)->scan(DateTime{2}, Duration{});
    bench.scan();
    auto expected = wire(std::int32_t{4});
    const auto second = wire(std::int16_t{6});
    expected.insert(expected.end(), second.begin(), second.end());
    CHECK(bench.answer()->bytes == expected);
    CHECK(bench.write("Count", wire(std::int32_t{100})) == LabelStatus::Done);
    (*plc)->scan(DateTime{3}, Duration{});
    CHECK(bench.read("Count") == wire(std::int32_t{102}));
}

} // namespace label_change_test
