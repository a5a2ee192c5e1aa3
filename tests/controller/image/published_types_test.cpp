#include <catch2/catch.hpp>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/program_image.hpp>

#include "controller/publishing/program_parts.hpp"
#include "server/image_fixture.hpp"

namespace published_types_test {

// The types of values in the image, and those that the nodes say.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

using E = ElementaryType;
using B = BuiltInType;

constexpr std::int64_t half_past_one = (90 * 60 + 5) * 10'000'000LL; // and 5 s

struct TypeRow {
    E type;
    B built_in;
    B plcopen;
    Variant declared;
    /// What it is published as, and with the types of OPC 30000.
    Variant begins;
    Variant begins_plcopen;
};

/// Each elementary type once.
std::vector<TypeRow> type_rows()
{
    const auto number = [](E type, B built_in, std::int64_t declared, Variant begins) {
        return TypeRow{type, built_in, built_in, declared, begins, begins};
    };
    const auto same = [](E type, B built_in, Variant value) {
        return TypeRow{type, built_in, built_in, value, value, value};
    };
    return {
        same(E::Bool, B::Boolean, true),
        number(E::Sint, B::SByte, -3, std::int8_t{-3}),
        number(E::Int, B::Int16, -4, std::int16_t{-4}),
        number(E::Dint, B::Int32, -5, std::int32_t{-5}),
        number(E::Lint, B::Int64, -6, std::int64_t{-6}),
        number(E::Usint, B::Byte, 3, std::uint8_t{3}),
        number(E::Uint, B::UInt16, 4, std::uint16_t{4}),
        number(E::Udint, B::UInt32, 5, std::uint32_t{5}),
        number(E::Ulint, B::UInt64, 6, std::uint64_t{6}),
        number(E::Byte, B::Byte, 0xF3, std::uint8_t{0xF3}),
        number(E::Word, B::UInt16, 0xF004, std::uint16_t{0xF004}),
        number(E::Dword, B::UInt32, 0xF000'0005, std::uint32_t{0xF000'0005}),
        {E::Lword, B::UInt64, B::UInt64, UINT64_MAX, UINT64_MAX, UINT64_MAX},
        {E::Real, B::Float, B::Float, 0.5, 0.5F, 0.5F},
        same(E::Lreal, B::Double, 0.25),
        {E::Time, B::Double, B::Int64, 1499.75, 1499.75, std::int64_t{1500}},
        same(E::Date, B::DateTime, DateTime{7}),
        {E::TimeOfDay, B::DateTime, B::UInt32, DateTime{half_past_one}, DateTime{half_past_one},
         std::uint32_t{(90 * 60 + 5) * 1'000}},
        same(E::DateAndTime, B::DateTime, DateTime{9}),
        same(E::String, B::String, String{"pump"}),
        {E::Ltime, B::Double, B::Int64, 1.00025, 1.00025, std::int64_t{1'000'250}},
        same(E::Ldate, B::DateTime, DateTime{7}),
        {E::LtimeOfDay, B::DateTime, B::UInt64, DateTime{half_past_one}, DateTime{half_past_one},
         std::uint64_t{(90 * 60 + 5) * 1'000'000'000ULL}},
        same(E::LdateAndTime, B::DateTime, DateTime{9}),
        same(E::Char, B::String, String{"p"}),
        same(E::Wchar, B::String, String{"\u6E29"}),
        same(E::Wstring, B::String, String{"\u6E29\u5EA6"}),
    };
}

/// A value that no row begins with.
Variant another(BuiltInType type)
{
    switch (type) {
    case B::Boolean:
        return false;
    case B::SByte:
        return std::int8_t{-100};
    case B::Int16:
        return std::int16_t{-1'000};
    case B::Int32:
        return std::int32_t{-100'000};
    case B::Int64:
        return std::int64_t{-10'000'000'000};
    case B::Byte:
        return std::uint8_t{200};
    case B::UInt16:
        return std::uint16_t{60'000};
    case B::UInt32:
        return std::uint32_t{86'399'999};
    case B::UInt64:
        return UINT64_MAX - 1;
    case B::Float:
        return 1.5F;
    case B::Double:
        return 2.5;
    case B::DateTime:
        return DateTime{1'000};
    default:
        return String{"v"};
    }
}

const auto any_encoding = [](const DerivedType&) { return NodeId{1, 1}; };

/// One variable in a running image, and a client.
struct OneVariable {
    OneVariable(GlobalVariable declared, ElementaryTypes choice)
        : program{.variables = {std::move(declared)}}, types{ProgramTypes::create(program).value()},
          made{ProgramImage::create(types, std::vector<std::size_t>{0}, any_encoding,
                                    {.elementary = choice})
                   .value()}
    {
        sources.add(source);
        scan();
    }
    void scan()
    {
        made.image()->begin_scan();
        made.image()->publish(DateTime{++scans});
        sources.handle_completions();
    }
    [[nodiscard]] Variant seen() const { return made.image()->pin().value(0); }
    [[nodiscard]] StatusCode write(const Variant& value)
    {
        const DataValue data{value};
        server::detail::SourceWrite call{sources, 1};
        call.ask(0, 0, {0, nullptr, &data});
        busbar::test::CallEnd owner;
        owner.done = call.start(owner, TimePoint{}, [](auto&) {});
        scan();
        REQUIRE(owner.done);
        return call.result(0);
    }

    Program program;
    ProgramTypes types;
    ProgramImage made;
    busbar::test::TestWaker waker;
    server::ImageSource source{made.image()};
    server::detail::DataSources sources{&waker};
    std::int64_t scans{0};
};

} // namespace

TEST_CASE("Node, image and value are of one type, and what is written is read (6-2-2)")
{
    const auto rows = type_rows();
    REQUIRE(rows.size() == static_cast<std::size_t>(E::Wstring) + 1);
    for (const ElementaryTypes choice : {ElementaryTypes::BuiltIn, ElementaryTypes::Plcopen}) {
        const bool is_plcopen = choice == ElementaryTypes::Plcopen;
        for (const TypeRow& row : rows) {
            INFO(name(row.type) << (is_plcopen ? " of PLCopen" : ""));
            const B expected = is_plcopen ? row.plcopen : row.built_in;
            CHECK(data_type_of(row.type, choice, 3).built_in == expected);
            GlobalVariable declared = variable("V", use(row.type));
            declared.initial.value = row.declared;
            OneVariable one{declared, choice};
            CHECK(one.made.image()->place(0).type == expected);
            CHECK(one.seen() == (is_plcopen ? row.begins_plcopen : row.begins));
            const Variant written = another(expected);
            CHECK(one.write(written) == status::Good);
            CHECK(one.made.image()->memory().load(0) == written);
            CHECK(one.seen() == written);
            const Variant wrong = another(expected == B::Double ? B::Int64 : B::Double);
            CHECK(one.write(wrong) == status::Bad_TypeMismatch);
            CHECK(one.seen() == written);
        }
    }
}

TEST_CASE("An enumeration is an Int32 with either choice (6-2-2)")
{
    for (const ElementaryTypes choice : {ElementaryTypes::BuiltIn, ElementaryTypes::Plcopen}) {
        Program program;
        program.types = {{.name = "Mode",
                          .kind = DerivedType::Kind::Enumeration,
                          .enumerators = {{"Off", 3}, {"On", 5}}}};
        program.variables = {variable("V", use("Mode"))};
        const auto types = ProgramTypes::create(program).value();
        const std::vector<std::size_t> all{0};
        const auto made = ProgramImage::create(types, all, any_encoding, {.elementary = choice});
        REQUIRE(made);
        CHECK(made->image()->memory().load(0) == Variant{3});
    }
}

TEST_CASE("Members of a structure follow the choice too (6-2-2)")
{
    Program program;
    program.types = {structure("Shift", {use(E::Time), use(E::TimeOfDay)})};
    program.types[0].members[0].initial.value = -2.5;
    program.types[0].members[1].initial.value = DateTime{10'000};
    program.variables = {variable("V", use("Shift"))};
    const auto types = ProgramTypes::create(program).value();
    const std::vector<std::size_t> all{0};
    const auto made =
        ProgramImage::create(types, all, any_encoding, {.elementary = ElementaryTypes::Plcopen});
    REQUIRE(made);
    const auto view = made->image()->memory().structure(0);
    CHECK(view.value<std::int64_t>(0) == -3);
    CHECK(view.value<std::uint32_t>(1) == 1);
}

TEST_CASE("A time that the types of PLCopen do not have is refused (6-2-2)")
{
    const auto refused = [](E type, Variant initial) {
        Program program;
        program.variables = {variable("V", use(type))};
        program.variables[0].initial.value = std::move(initial);
        const auto types = ProgramTypes::create(program).value();
        const std::vector<std::size_t> all{0};
        return !ProgramImage::create(types, all, any_encoding,
                                     {.elementary = ElementaryTypes::Plcopen});
    };
    CHECK(refused(E::Time, 1e19));
    CHECK(refused(E::TimeOfDay, DateTime{86'400LL * 10'000'000}));
    CHECK(refused(E::TimeOfDay, DateTime{-1}));
    CHECK_FALSE(refused(E::TimeOfDay, DateTime{86'400LL * 10'000'000 - 1}));
}

TEST_CASE("A program's variables may stay in a runtime's memory (6-2-2)")
{
    struct Point {
        std::int16_t x;
        double y;
    };
    std::int16_t speed = 12;
    Point home{1, 2.5};
    Program program;
    program.types = {structure("Point", {use(E::Int), use(E::Lreal)})};
    program.variables = {variable("Speed"), variable("Home", use("Point")), variable("Own")};
    program.variables[0].initial.value = std::int64_t{5};
    program.variables[2].initial.value = std::int64_t{6};
    const auto types = ProgramTypes::create(program).value();
    ProgramImageOptions options;
    options.runtime_of = [&](const GlobalVariable& one) -> std::span<std::byte> {
        if (one.name == "Own") {
            return {};
        }
        return one.name == "Speed" ? std::as_writable_bytes(std::span{&speed, 1})
                                   : std::as_writable_bytes(std::span{&home, 1});
    };
    const std::vector<std::size_t> all{0, 1, 2};
    const auto made = ProgramImage::create(types, all, any_encoding, options);
    REQUIRE(made);
    CHECK(speed == 12); // as the runtime has it
    speed = 13;
    made->image()->publish(DateTime{1});
    const server::ImagePin pin = made->image()->pin();
    CHECK(pin.value(0) == Variant{std::int16_t{13}});
    CHECK(pin.value(2) == Variant{std::int16_t{6}});
    CHECK(pin.bytes(1)[0] == std::byte{1});
    options.runtime_of = [&](const GlobalVariable&) {
        return std::as_writable_bytes(std::span{&speed, 1});
    };
    const auto refused = ProgramImage::create(types, all, any_encoding, options);
    REQUIRE_FALSE(refused);
    CHECK(text(refused.error()).starts_with("variables[1] (Home): has another size or alignment"));
}

} // namespace published_types_test
