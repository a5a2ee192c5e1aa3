#include <busbar/backend/modbus_value.hpp>

#include <limits>

#include <catch2/catch.hpp>

#include <busbar/core/string.hpp>

namespace modbus_value_test {

using namespace busbar;
using namespace busbar::backend;
using Words = std::vector<std::uint16_t>;
using Type = ModbusType;
using Order = ModbusOrder;

TEST_CASE("Values are read from and written to registers in each order")
{
    struct Row {
        ModbusValueType type;
        Variant value;
        Words registers;
    };
    const auto row = GENERATE(values<Row>({
        // Rows of the vectors and of tests of other implementations.
        {{Type::Float, Order::ABCD, 0}, 123456.0F, {0x47F1, 0x2000}},
        {{Type::Float, Order::CDAB, 0}, 123456.0F, {0x2000, 0x47F1}},
        {{Type::Float, Order::BADC, 0}, 123456.0F, {0xF147, 0x0020}},
        {{Type::Float, Order::DCBA, 0}, 123456.0F, {0x0020, 0xF147}},
        {{Type::Float, Order::ABCD, 0}, 3.1415927410125732F, {0x4049, 0x0FDB}},
        {{Type::Int16, Order::ABCD, 0}, std::int16_t{-2}, {0xFFFE}},
        {{Type::Int16, Order::BADC, 0}, std::int16_t{-2}, {0xFEFF}},
        {{Type::UInt16, Order::ABCD, 0}, std::uint16_t{0x1234}, {0x1234}},
        {{Type::Int32, Order::CDAB, 0}, std::int32_t{-2}, {0xFFFE, 0xFFFF}},
        {{Type::UInt32, Order::ABCD, 0}, std::uint32_t{0x01020304}, {0x0102, 0x0304}},
        {{Type::UInt32, Order::DCBA, 0}, std::uint32_t{0x01020304}, {0x0403, 0x0201}},
        {{Type::Int64, Order::ABCD, 0}, std::int64_t{-3}, {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFD}},
        {{Type::UInt64, Order::ABCD, 0},
         std::uint64_t{0x0102030405060708},
         {0x0102, 0x0304, 0x0506, 0x0708}},
        {{Type::UInt64, Order::CDAB, 0},
         std::uint64_t{0x0102030405060708},
         {0x0708, 0x0506, 0x0304, 0x0102}},
        {{Type::UInt64, Order::BADC, 0},
         std::uint64_t{0x0102030405060708},
         {0x0201, 0x0403, 0x0605, 0x0807}},
        {{Type::UInt64, Order::DCBA, 0},
         std::uint64_t{0x0102030405060708},
         {0x0807, 0x0605, 0x0403, 0x0201}},
        {{Type::Double, Order::ABCD, 0}, 1.0, {0x3FF0, 0, 0, 0}},
        {{Type::Double, Order::CDAB, 0}, 1.0, {0, 0, 0, 0x3FF0}},
        {{Type::Bcd16, Order::ABCD, 0}, std::uint16_t{9876}, {0x9876}},
        {{Type::Bcd16, Order::BADC, 0}, std::uint16_t{9876}, {0x7698}},
        {{Type::Bcd32, Order::ABCD, 0}, std::uint32_t{12345678}, {0x1234, 0x5678}},
        {{Type::Bcd32, Order::CDAB, 0}, std::uint32_t{12345678}, {0x5678, 0x1234}},
        {{Type::Bcd32, Order::BADC, 0}, std::uint32_t{12345678}, {0x3412, 0x7856}},
        {{Type::Bcd32, Order::DCBA, 0}, std::uint32_t{12345678}, {0x7856, 0x3412}},
        {{Type::Bcd64, Order::ABCD, 0},
         std::uint64_t{1234567890123456},
         {0x1234, 0x5678, 0x9012, 0x3456}},
        {{Type::Bool, Order::ABCD, 0}, true, {1}},
        {{Type::Bool, Order::ABCD, 0}, false, {0}},
        {{Type::Text, Order::ABCD, 5}, String{"abcde"}, {0x6162, 0x6364, 0x6500}},
        {{Type::Text, Order::BADC, 5}, String{"abcde"}, {0x6261, 0x6463, 0x0065}},
        {{Type::Text, Order::ABCD, 6}, String{"ab"}, {0x6162, 0, 0}},
        {{Type::Text, Order::ABCD, 2}, String{""}, {0}},
    }));
    CHECK(registers_of(row.type) == row.registers.size());
    const auto value = read_modbus(row.type, row.registers);
    REQUIRE(value);
    CHECK(*value == row.value);
    CHECK(value->type() == data_type_of(row.type.type));
    Words registers(row.registers.size(), 0xEEEE);
    CHECK(write_modbus(row.type, row.value, registers) == status::Good);
    CHECK(registers == row.registers);
}

TEST_CASE("Registers that are not such a value are refused")
{
    CHECK(read_modbus({Type::Bcd16, Order::ABCD, 0}, Words{0x12A4}).error() ==
          status::Bad_DecodingError);
    CHECK(read_modbus({Type::Bcd64, Order::ABCD, 0}, Words{0xA000, 0, 0, 0}).error() ==
          status::Bad_DecodingError);
    CHECK(read_modbus({Type::Text, Order::ABCD, 2}, Words{0xFF41}).error() ==
          status::Bad_DecodingError);
    CHECK(read_modbus({Type::Float, Order::ABCD, 0}, Words{1}).error() ==
          status::Bad_DecodingError);
    // What follows the end of a text is not part of it.
    CHECK(*read_modbus({Type::Text, Order::ABCD, 4}, Words{0x4100, 0xFFFF}) == Variant{"A"});
    CHECK(*read_modbus({Type::Text, Order::ABCD, 3}, Words{0x4142, 0x43FF}) == Variant{"ABC"});
    CHECK(*read_modbus({Type::Bool, Order::ABCD, 0}, Words{0x8000}) == Variant{true});
}

TEST_CASE("Values that do not fit leave the registers as they are")
{
    struct Row {
        ModbusValueType type;
        Variant value;
        StatusCode status;
    };
    const auto row = GENERATE(values<Row>({
        {{Type::Bcd16, Order::ABCD, 0}, std::uint16_t{10000}, status::Bad_OutOfRange},
        {{Type::Bcd32, Order::ABCD, 0}, std::uint32_t{100000000}, status::Bad_OutOfRange},
        {{Type::Bcd64, Order::ABCD, 0},
         std::numeric_limits<std::uint64_t>::max(),
         status::Bad_OutOfRange},
        {{Type::Text, Order::ABCD, 3}, String{"abcd"}, status::Bad_OutOfRange},
        {{Type::Text, Order::ABCD, 3}, String{std::string_view{"a\0b", 3}}, status::Bad_OutOfRange},
        {{Type::Int16, Order::ABCD, 0}, std::uint16_t{1}, status::Bad_TypeMismatch},
        {{Type::Int32, Order::ABCD, 0}, Variant{}, status::Bad_TypeMismatch},
        {{Type::Int16, Order::ABCD, 0}, Variant{Array<std::int16_t>(1)}, status::Bad_TypeMismatch},
    }));
    Words registers(registers_of(row.type), 0xEEEE);
    CHECK(write_modbus(row.type, row.value, registers) == row.status);
    CHECK(registers == Words(registers_of(row.type), 0xEEEE));
}

} // namespace modbus_value_test
