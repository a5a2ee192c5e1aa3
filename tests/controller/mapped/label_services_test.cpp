#include "label_world.hpp"

namespace label_services_test {

// Read, Write and Call of a whole server over the labels of a simulated PLC.

using namespace busbar;
using namespace busbar::test;
using controller::MappedPart;

namespace {

const std::string pair_type = "TYPE Pair : STRUCT Count : INT; Speed : REAL; Name : STRING[8]; "
                              "END_STRUCT; END_TYPE";
const std::string variables =
    "Speed : INT := 1480; Total : UDINT := 4000000000; Angle : LREAL := 0.5; Text : STRING[6]; "
    "Wide : ARRAY [0..4] OF UTF16_UNIT; Delay : TIMER; Pause : TIME := T#2s; "
    "Row : ARRAY [0..2, 0..1] OF INT; Pairs : ARRAY [0..1] OF Pair; One : Pair; "
    "Start : WORD; Amount : DINT; Note : STRING[8]; Done : INT;";

NodeId standard(std::uint32_t type)
{
    return NodeId{0, type};
}

struct Fixture : LabelWorld {
    explicit Fixture(LabelWorldOptions options = {})
        : LabelWorld{pair_type, variables, std::move(options)}
    {
        add("speed", standard(id::Int16), "Speed");
        add("total", standard(id::Int64), "Total");
        add("angle", standard(id::Float), "Angle");
        add("text", standard(id::String), "Text");
        add("wide", standard(id::LocalizedText), "Wide");
        add("contact", standard(id::Boolean), "delay.s");
        add("current", standard(id::UInt16), "Delay.N");
        add("pause", standard(id::Int32), "Pause");
        add("row", standard(id::Int16), part_of({element(0, "Row[2,1]"), element(1, "Row[0][1]")}),
            2);
    }
    /// A DataType of that name, with fields as the PLC's own structure has them.
    NodeId add_pair_type()
    {
        StructureDefinition definition;
        for (const auto& [name, type] :
             {std::pair{"Count", id::Int32}, {"Speed", id::Double}, {"Name", id::String}}) {
            StructureField field;
            field.name = name;
            field.data_type = standard(type);
            field.value_rank = -1;
            definition.fields.push_back(field);
        }
        model::AddressSpace& space = server().address_space();
        REQUIRE(model::add_structure_type(space, named("PairType", standard(id::Structure)),
                                          std::move(definition)));
        return own("PairType");
    }
    [[nodiscard]] const binary::DynamicTypes& types()
    {
        return data_types.of(server().address_space());
    }
    [[nodiscard]] ExtensionObject pair(std::int32_t count, double speed, const char* name)
    {
        binary::DynamicValue value{*types().find(own("PairType"))};
        REQUIRE(value.set("Count", Variant{count}));
        REQUIRE(value.set("Speed", Variant{speed}));
        REQUIRE(value.set("Name", Variant{String{name}}));
        return binary::to_extension_object(value).value();
    }
    [[nodiscard]] std::string pair_text(const ExtensionObject& object)
    {
        const auto value = binary::decode_dynamic(object, types());
        REQUIRE(value);
        return binary::to_text(*value);
    }
};

controller::PlcConfig acknowledging()
{
    controller::PlcConfig config;
    controller::PlcProgram& program = config.programs.emplace_back();
    program.kind = controller::PlcProgramKind::Acknowledge;
    program.target = "Start";
    program.sets = "Done";
    program.to = 7;
    return config;
}

struct Calls : Fixture {
    explicit Calls(controller::PlcConfig plc = acknowledging()) : Fixture{{.plc = std::move(plc)}}
    {
        controller::MethodMapping method;
        method.handle = "Start";
        method.arguments.resize(2);
        method.arguments[0].label = "Amount";
        method.arguments[1].number = 1;
        method.arguments[1].label = "Note";
        add("start",
            {{"amount", standard(id::UInt16), -1, {}, {}},
             {"note", standard(id::String), -1, {}, {}}},
            method);
        start();
    }
    CallMethodResult go(std::uint16_t amount)
    {
        return call("start", {Variant{amount}, Variant{String{"go"}}});
    }
};
/// Its program never clears bit 0.
struct Stuck : Calls {
    Stuck() : Calls{controller::PlcConfig{}} {}
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Read: a simulated PLC's labels of one scan, with its time",
                 "[8.3][8.2]")
{
    start();
    const auto values =
        read_all({"speed", "total", "angle", "text", "contact", "current", "pause", "row"});
    REQUIRE(values.size() == 8);
    CHECK(values[0].value == Variant{std::int16_t{1480}});
    CHECK(values[1].value == Variant{std::int64_t{4'000'000'000}});
    CHECK(values[2].value == Variant{0.5F});
    CHECK(values[3].value == Variant{String{""}});
    CHECK(values[4].value == Variant{false});
    CHECK(values[5].value == Variant{std::uint16_t{0}});
    CHECK(values[6].value == Variant{std::int32_t{2'000}});
    CHECK(values[7].value == Variant{Array<std::int16_t>{0, 0}});
    for (const DataValue& value : values) {
        CHECK(value.status == status::Good);
        CHECK(value.source_timestamp == values[0].source_timestamp);
    }
    // The time of a scan, not that of the answer.
    const DateTime first = values[0].source_timestamp;
    const DateTime second = read("speed").source_timestamp;
    constexpr std::int64_t cycle = 200'000; // 20 ms
    CHECK(second > first);
    CHECK((second.ticks - first.ticks) % cycle == 0);
}

TEST_CASE_METHOD(Fixture, "8.3 Write: what is written is in the PLC and is read again",
                 "[8.3][8.2]")
{
    start();
    const auto results = write({{"speed", Variant{std::int16_t{-5}}},
                                {"total", Variant{std::int64_t{17}}},
                                {"angle", Variant{-1.25F}},
                                {"text", Variant{String{"aé亜b"}}},
                                {"wide", Variant{LocalizedText{String{"a😀b"}}}},
                                {"contact", Variant{true}},
                                {"row", Variant{Array<std::int16_t>{8, 9}}}});
    CHECK(std::count(results.begin(), results.end(), status::Good) == 7);
    CHECK(variable<std::int16_t>("Speed") == -5);
    CHECK(variable<std::uint32_t>("Total") == 17);
    CHECK(variable<double>("Angle") == -1.25);
    CHECK(read("text").value == Variant{String{"a・亜b"}});
    CHECK(read("wide").value == Variant{LocalizedText{String{"a😀b"}}});
    CHECK(read("contact").value == Variant{true});
    CHECK(read("row").value == Variant{Array<std::int16_t>{8, 9}});
}

TEST_CASE_METHOD(Fixture, "8.3 Write: one value that has no room leaves all labels as they were",
                 "[8.3][8.1]")
{
    start();
    const auto results =
        write({{"speed", Variant{std::int16_t{9}}}, {"total", Variant{std::int64_t{-1}}}});
    CHECK(results[1] == status::Bad_OutOfRange);
    CHECK(results[0].is_bad());
    CHECK(variable<std::int16_t>("Speed") == 1480);
}

TEST_CASE_METHOD(Fixture, "8.1 Write: more and fewer elements than the Variable has", "[8.1]")
{
    start();
    CHECK(write("row", Variant{Array<std::int16_t>{1, 2, 3}}) == status::Bad_WriteNotSupported);
    CHECK(write("row", Variant{Array<std::int16_t>{1}}) == status::Bad_WriteNotSupported);
    CHECK(write("row", Variant{Array<std::int32_t>{1, 2, 3}}) == status::Bad_TypeMismatch);
    CHECK(write("row", Variant{std::int16_t{1}}) == status::Bad_TypeMismatch);
    // Another ValueRank is another type (Part 4, 5.11.4.4), whatever elements there are.
    CHECK(write("row", Variant::matrix(Array<std::int16_t>{1, 2}, Array<std::uint32_t>{1, 2})) ==
          status::Bad_TypeMismatch);
    CHECK(read("row").value == Variant{Array<std::int16_t>{0, 0}});
}

TEST_CASE_METHOD(Fixture, "8.1 Write: an array in a structure with more and fewer elements",
                 "[8.1]")
{
    StructureDefinition definition;
    StructureField list;
    list.name = "Amounts";
    list.data_type = standard(id::Int16);
    list.value_rank = 1;
    list.array_dimensions = {2};
    StructureField text;
    text.name = "Text";
    text.data_type = standard(id::String);
    text.value_rank = -1;
    text.max_string_length = 4;
    definition.fields = {list, text};
    REQUIRE(model::add_structure_type(server().address_space(),
                                      named("BatchType", standard(id::Structure)),
                                      std::move(definition)));
    MappedPart amounts = field("Amounts", {});
    amounts.is_array = true;
    amounts.parts = {element(0, "Row[0,0]"), element(1, "Row[0,1]")};
    add("batch", own("BatchType"), part_of({amounts}));
    start();
    const auto batch = [&](const Array<std::int16_t>& numbers, const char* name) {
        binary::DynamicValue value{*types().find(own("BatchType"))};
        REQUIRE(value.set("Amounts", Variant{numbers}));
        REQUIRE(value.set("Text", Variant{String{name}}));
        return Variant{binary::to_extension_object(value).value()};
    };
    CHECK(write("batch", batch({1, 2}, "a")) == status::Good);
    CHECK(write("batch", batch({1}, "a")) == status::Bad_WriteNotSupported);
    CHECK(write("batch", batch({1, 2, 3}, "a")) == status::Bad_WriteNotSupported);
    // What is too long besides is told as it is elsewhere (Part 4, 5.11.4.4).
    CHECK(write("batch", batch({1, 2}, "abcde")) == status::Bad_OutOfRange);
    CHECK(write("batch", batch({1, 2, 3}, "abcde")) == status::Bad_OutOfRange);
}

TEST_CASE_METHOD(Fixture, "8.3 Read: a value that no node can have fails the request (1A01H)",
                 "[8.3]")
{
    add("narrow", standard(id::Int16), "Amount");
    start();
    variable<std::int32_t>("Amount") = 70'000;
    const auto values = read_all({"speed", "narrow"});
    CHECK(values[0].status == status::Bad_NoCommunication);
    CHECK(values[1].status == status::Bad_NoCommunication);
    CHECK(book.errors == std::vector{MappedErrorCode::OutOfRange});
    CHECK(book.label == "Amount");
    CHECK(book.node == own("narrow"));
    CHECK(read("speed").status == status::Good);
}

TEST_CASE("8.3 Access unit: a Read that is divided over scans can be torn, else it cannot", "[8.3]")
{
    const bool is_divided = GENERATE(false, true);
    controller::PlcConfig counting;
    counting.programs.resize(2);
    counting.programs[0].target = "Amount";
    counting.programs[1].target = "Done";
    Fixture world{{.labels = {.access_unit = is_divided ? 1U : 0U}, .plc = counting}};
    world.add("amount", standard(id::Int32), "Amount");
    world.add("done", standard(id::Int16), "Done");
    world.start();
    const auto values = world.read_all({"amount", "done"});
    REQUIRE(values[1].status == status::Good);
    const auto first = *values[0].value.get_if<std::int32_t>();
    const auto second = *values[1].value.get_if<std::int16_t>();
    CHECK(first > 0);
    CHECK(second - first == (is_divided ? 1 : 0));
}

TEST_CASE_METHOD(Fixture, "8.2 Structures: an own DataType and an array of it, both ways",
                 "[8.2][8.3]")
{
    const NodeId type = add_pair_type();
    const auto fields = [](const std::string& of) {
        return std::vector{field("Count", of + ".Count"), field("Speed", of + ".Speed"),
                           field("Name", of + ".Name")};
    };
    add("one", type, part_of({field("Speed", "One.Speed")}), 0, Variant{pair(3, 0, "kept")});
    add("pairs", type,
        part_of({element(0, "", fields("Pairs[0]")), element(1, "", fields("Pairs[1]"))}), 2);
    start();
    CHECK(pair_text(*read("one").value.get_if<ExtensionObject>()) ==
          "PairType {Count: 3, Speed: 0, Name: \"kept\"}");
    const Array<ExtensionObject> values{pair(1, 1.5, "a"), pair(-2, 0.25, "bc")};
    CHECK(write("pairs", Variant{values}) == status::Good);
    const DataValue all = read("pairs");
    const auto* const objects = all.value.array_if<ExtensionObject>();
    REQUIRE(objects != nullptr);
    REQUIRE(objects->size() == 2);
    CHECK(pair_text((*objects)[0]) == "PairType {Count: 1, Speed: 1.5, Name: \"a\"}");
    CHECK(pair_text((*objects)[1]) == "PairType {Count: -2, Speed: 0.25, Name: \"bc\"}");
    // Count does not fit INT, which leaves both elements as they were.
    CHECK(write("pairs", Variant{Array<ExtensionObject>{pair(5, 5, "c"), pair(40'000, 0, "")}}) ==
          status::Bad_OutOfRange);
    CHECK(read("pairs").value == all.value);
    // What has no label keeps what was written to it.
    CHECK(write("one", Variant{pair(9, 2.5, "new")}) == status::Good);
    CHECK(pair_text(*read("one").value.get_if<ExtensionObject>()) ==
          "PairType {Count: 9, Speed: 2.5, Name: \"new\"}");
}

TEST_CASE_METHOD(Fixture, "8.2 Structures: fields are told apart whatever is in their names",
                 "[8.2]")
{
    const auto add_type = [&](const char* name,
                              std::vector<std::pair<const char*, NodeId>> fields) {
        StructureDefinition definition;
        for (const auto& [field_name, type] : fields) {
            StructureField& field = definition.fields.emplace_back();
            field.name = field_name;
            field.data_type = type;
            field.value_rank = -1;
        }
        REQUIRE(model::add_structure_type(
            server().address_space(), named(name, standard(id::Structure)), std::move(definition)));
        return own(name);
    };
    const NodeId int16 = standard(id::Int16);
    const NodeId inner = add_type("Inner", {{"B", int16}});
    const NodeId type = add_type("Names", {{"A", inner}, {"A.B", int16}, {"A[0]\\", int16}});
    MappedPart a = field("A", "");
    a.parts = {field("B", "One.Count")};
    add("names", type, part_of({a, field("A.B", "Speed"), field("A[0]\\", "Done")}));
    start();
    variable<std::int16_t>("Done") = 3;
    CHECK(pair_text(*read("names").value.get_if<ExtensionObject>()) ==
          "Names {A: Inner {B: 0}, A.B: 1480, A[0]\\: 3}");
}

TEST_CASE_METHOD(Calls, "8.3 Call: the program finds the inputs, clears bit 0 and is called again",
                 "[8.3][8.1]")
{
    CHECK(go(4).status_code == status::Good);
    run_scans(2);
    CHECK(variable<std::uint16_t>("Start") == 0);
    CHECK(variable<std::int16_t>("Done") == 7);
    CHECK(variable<std::int32_t>("Amount") == 4);
    CHECK(go(5).status_code == status::Good);
    CHECK(variable<std::int32_t>("Amount") == 5);
}

TEST_CASE_METHOD(Stuck, "8.3 Call: a program that leaves bit 0 on is busy", "[8.3][8.1]")
{
    CHECK(go(4).status_code == status::Good);
    run_scans(2);
    CHECK(variable<std::uint16_t>("Start") == 1);
    CHECK(go(5).status_code == status::Bad_TooManyOperations);
    CHECK(variable<std::int32_t>("Amount") == 4);
    variable<std::uint16_t>("Start") = 0;
    CHECK(go(6).status_code == status::Good);
    CHECK(variable<std::int32_t>("Amount") == 6);
}

TEST_CASE_METHOD(Calls, "8.1 Call: an input that its label cannot have, and the bit stays off",
                 "[8.1]")
{
    const auto result = call("start", {Variant{std::uint16_t{1}}, Variant{std::int16_t{2}}});
    CHECK(result.status_code == status::Bad_InvalidArgument);
    run_scans(2);
    CHECK(variable<std::int16_t>("Done") == 0);
}

} // namespace label_services_test
