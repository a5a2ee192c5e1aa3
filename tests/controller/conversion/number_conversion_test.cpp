#include <catch2/catch.hpp>

#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "label_values.hpp"

namespace number_conversion_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct IntegerType {
    BuiltInType type;
    std::int64_t least;
    std::uint64_t greatest;
};
constexpr std::array integers{
    IntegerType{BuiltInType::SByte, INT8_MIN, INT8_MAX},
    IntegerType{BuiltInType::Byte, 0, UINT8_MAX},
    IntegerType{BuiltInType::Int16, INT16_MIN, INT16_MAX},
    IntegerType{BuiltInType::UInt16, 0, UINT16_MAX},
    IntegerType{BuiltInType::Int32, INT32_MIN, INT32_MAX},
    IntegerType{BuiltInType::UInt32, 0, UINT32_MAX},
    IntegerType{BuiltInType::Int64, INT64_MIN, INT64_MAX},
    IntegerType{BuiltInType::UInt64, 0, UINT64_MAX},
};

struct LabelOf {
    LabelKind kind;
    std::int64_t least;
    std::int64_t greatest;
};
constexpr std::array labels{
    LabelOf{{LabelType::UnsignedWord}, 0, UINT16_MAX},
    LabelOf{{LabelType::UnsignedDoubleWord}, 0, UINT32_MAX},
    LabelOf{{LabelType::Word}, INT16_MIN, INT16_MAX},
    LabelOf{{LabelType::DoubleWord}, INT32_MIN, INT32_MAX},
    LabelOf{{LabelType::Timer, TimerPart::Current}, 0, UINT16_MAX},
    LabelOf{{LabelType::RetentiveTimer, TimerPart::Current}, 0, UINT16_MAX},
    LabelOf{{LabelType::LongTimer, TimerPart::Current}, 0, UINT32_MAX},
    LabelOf{{LabelType::LongRetentiveTimer, TimerPart::Current}, 0, UINT32_MAX},
    LabelOf{{LabelType::Counter, TimerPart::Current}, 0, UINT16_MAX},
    LabelOf{{LabelType::LongCounter, TimerPart::Current}, 0, UINT32_MAX},
};

// Both sides of every border that a type or label has.
constexpr std::array<std::int64_t, 26> numbers{
    0,
    1,
    -1,
    INT8_MAX,
    INT8_MAX + 1,
    INT8_MIN,
    INT8_MIN - 1,
    UINT8_MAX,
    UINT8_MAX + 1,
    INT16_MAX,
    INT16_MAX + 1,
    INT16_MIN,
    INT16_MIN - 1,
    UINT16_MAX,
    UINT16_MAX + 1,
    INT32_MAX,
    INT32_MAX + std::int64_t{1},
    INT32_MIN,
    INT32_MIN - std::int64_t{1},
    UINT32_MAX,
    UINT32_MAX + std::int64_t{1},
    INT64_MAX,
    INT64_MIN,
    42,
    -42,
    1'000'000,
};

bool has(const IntegerType& type, std::int64_t number)
{
    return number >= type.least && std::cmp_less_equal(number, type.greatest);
}

/// `number` as a scalar of that type, which has it.
Variant integer(BuiltInType type, std::int64_t number)
{
    switch (type) {
    case BuiltInType::SByte:
        return Variant{static_cast<std::int8_t>(number)};
    case BuiltInType::Byte:
        return Variant{static_cast<std::uint8_t>(number)};
    case BuiltInType::Int16:
        return Variant{static_cast<std::int16_t>(number)};
    case BuiltInType::UInt16:
        return Variant{static_cast<std::uint16_t>(number)};
    case BuiltInType::Int32:
        return Variant{static_cast<std::int32_t>(number)};
    case BuiltInType::UInt32:
        return Variant{static_cast<std::uint32_t>(number)};
    case BuiltInType::UInt64:
        return Variant{static_cast<std::uint64_t>(number)};
    default:
        return Variant{number};
    }
}

} // namespace

TEST_CASE("8.2 Integers: a Write keeps the value or is refused", "[8.2]")
{
    for (const IntegerType& type : integers) {
        for (const LabelOf& label : labels) {
            for (const std::int64_t number : numbers) {
                if (!has(type, number)) {
                    continue;
                }
                CAPTURE(name(type.type), static_cast<int>(label.kind.type), number);
                Mapping mapping{type.type, label.kind};
                const bool fits = number >= label.least && number <= label.greatest;
                CHECK(mapping.write(integer(type.type, number)) ==
                      (fits ? status::Good : status::Bad_OutOfRange));
                if (fits) {
                    CHECK(mapping.bytes() == number_bytes(number, mapping.label.size()));
                }
            }
        }
    }
}

TEST_CASE("8.2 Integers: a UInt64 past Int64 fits no label", "[8.2]")
{
    for (const LabelOf& label : labels) {
        Mapping mapping{BuiltInType::UInt64, label.kind};
        CHECK(mapping.write(Variant{UINT64_MAX}) == status::Bad_OutOfRange);
    }
}

TEST_CASE("8.2 Integers: a Read keeps the value or is out of range", "[8.2]")
{
    for (const IntegerType& type : integers) {
        for (const LabelOf& label : labels) {
            for (const std::int64_t number : numbers) {
                if (number < label.least || number > label.greatest) {
                    continue;
                }
                CAPTURE(name(type.type), static_cast<int>(label.kind.type), number);
                Mapping mapping{type.type, label.kind};
                const auto read = mapping.read_of(number_bytes(number, mapping.label.size()));
                CHECK(read.has_value() == has(type, number));
                CHECK((read ? *read == integer(type.type, number)
                            : read.error() == status::Bad_OutOfRange));
            }
        }
    }
}

TEST_CASE("8.2 Integers: an enumeration converts as Int32", "[8.2]")
{
    const controller::LeafType leaf{BuiltInType::Int32, true};
    Mapping word{leaf, {LabelType::Word}};
    CHECK(word.write(Variant{std::int32_t{-3}}) == status::Good);
    CHECK(word.read() == Variant{std::int32_t{-3}});
    CHECK(word.write(Variant{std::int32_t{40'000}}) == status::Bad_OutOfRange);
    Mapping unsigned_double{leaf, {LabelType::UnsignedDoubleWord}};
    CHECK(unsigned_double.read_of("\xFF\xFF\xFF\xFF").error() == status::Bad_OutOfRange);
}

TEST_CASE("8.2 Integers: a Time label has the milliseconds of an Int32", "[8.2]")
{
    Mapping time{BuiltInType::Int32, {LabelType::Time}};
    CHECK(time.write(Variant{std::int32_t{-90'061'001}}) == status::Good);
    CHECK(time.bytes() == number_bytes(-90'061'001, 4));
    CHECK(time.read() == Variant{std::int32_t{-90'061'001}});
}

TEST_CASE("8.2 Integers: bits, contacts and coils", "[8.2]")
{
    for (const LabelKind kind :
         {LabelKind{LabelType::Bit}, LabelKind{LabelType::LongTimer, TimerPart::Contact},
          LabelKind{LabelType::Counter, TimerPart::Coil}}) {
        Mapping bit{BuiltInType::Boolean, kind};
        CHECK(bit.write(Variant{true}) == status::Good);
        CHECK(bit.bytes() == "\x01");
        CHECK(bit.read() == Variant{true});
        CHECK(bit.write(Variant{false}) == status::Good);
        CHECK(bit.read() == Variant{false});
    }
}

TEST_CASE("8.2 Integers: a value of another type, a label of another size", "[8.2]")
{
    Mapping mapping{BuiltInType::Int16, {LabelType::Word}};
    CHECK(mapping.write(Variant{std::int32_t{1}}) == status::Bad_TypeMismatch);
    CHECK(mapping.write(Variant{Array<std::int16_t>{1}}) == status::Bad_TypeMismatch);
    mapping.label.pop_back();
    CHECK(mapping.write(Variant{std::int16_t{1}}) == status::Bad_InternalError);
    CHECK(mapping.read().error() == status::Bad_InternalError);
}

TEST_CASE("Scaled numbers go both ways, are rounded, and stay in the ranges of both types")
{
    using controller::LabelConversion;
    const auto scaled = [](BuiltInType type, LabelType label, double factor, double offset) {
        return LabelConversion::scaled({type}, {label}, factor, offset);
    };
    const auto read = [](const LabelConversion& conversion, auto raw) {
        std::array<std::byte, sizeof raw> bytes{};
        std::memcpy(bytes.data(), &raw, sizeof raw);
        return conversion.read(bytes);
    };
    // 0..27648 as -10..90
    const auto analog = scaled(BuiltInType::Double, LabelType::Word, 100.0 / 27'648, -10);
    REQUIRE(analog);
    CHECK(read(*analog, std::int16_t{0}) == Variant{-10.0});
    CHECK(read(*analog, std::int16_t{13'824}) == Variant{40.0});
    CHECK(read(*analog, std::int16_t{27'648}).value().get_if<double>() != nullptr);
    std::array<std::byte, 2> word{};
    CHECK(analog->write(Variant{40.0}, word) == status::Good);
    std::int16_t raw = 0;
    std::memcpy(&raw, word.data(), sizeof raw);
    CHECK(raw == 13'824);
    CHECK(analog->write(Variant{1e6}, word) == status::Bad_OutOfRange);
    CHECK(analog->write(Variant{std::numeric_limits<double>::quiet_NaN()}, word) ==
          status::Bad_OutOfRange);
    CHECK(analog->write(Variant{std::numeric_limits<double>::infinity()}, word) ==
          status::Bad_OutOfRange);
    CHECK(analog->write(Variant{40.0F}, word) == status::Bad_TypeMismatch);
    // Integers are rounded; what the type cannot have is told.
    const auto whole = scaled(BuiltInType::SByte, LabelType::Float, 0.5, 0);
    REQUIRE(whole);
    CHECK(read(*whole, 3.0F) == Variant{std::int8_t{2}});
    CHECK(read(*whole, -3.0F) == Variant{std::int8_t{-2}});
    CHECK(read(*whole, 254.0F) == Variant{std::int8_t{127}});
    CHECK(read(*whole, 256.0F).error() == status::Bad_OutOfRange);
    CHECK(read(*whole, std::numeric_limits<float>::quiet_NaN()).error() == status::Bad_OutOfRange);
    const auto large = scaled(BuiltInType::UInt64, LabelType::Double, 1, 0);
    REQUIRE(large);
    CHECK(read(*large, 18446744073709551616.0).error() == status::Bad_OutOfRange);
    CHECK(read(*large, -1.0).error() == status::Bad_OutOfRange);
    const auto small = scaled(BuiltInType::Float, LabelType::Double, 1, 0);
    CHECK(read(*small, 1e39).error() == status::Bad_OutOfRange);
    // Only numbers.
    CHECK_FALSE(scaled(BuiltInType::Boolean, LabelType::Word, 1, 0));
    CHECK_FALSE(scaled(BuiltInType::Double, LabelType::Bit, 1, 0));
    CHECK_FALSE(scaled(BuiltInType::Double, LabelType::String, 1, 0));
    CHECK_FALSE(LabelConversion::scaled({BuiltInType::Int32, true}, {LabelType::Word}, 1, 0));
    CHECK(LabelConversion::scaled({BuiltInType::Double}, {LabelType::Timer, TimerPart::Current}, 1,
                                  0));
}

} // namespace number_conversion_test
