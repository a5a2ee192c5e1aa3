#include <busbar/backend/modbus_address.hpp>

#include <catch2/catch.hpp>

namespace modbus_address_test {

using namespace busbar;
using namespace busbar::backend;

namespace {

/// What an address reads as, or why it does not.
std::string canonical(std::string_view address)
{
    const auto parsed = parse_modbus_address(address);
    if (!parsed) {
        return text(parsed.error());
    }
    const std::string written = to_text(*parsed);
    const auto again = parse_modbus_address(written);
    REQUIRE(again);
    CHECK(*again == *parsed);
    return written;
}

} // namespace

TEST_CASE("Addresses of Modbus are read from 0 by name and from 1 by number")
{
    struct Row {
        std::string_view address;
        std::string_view canonical;
    };
    const auto row = GENERATE(values<Row>({
        {"40001", "holding:0"},
        {"400001", "holding:0"},
        {"40010", "holding:9"},
        {"400010", "holding:9"},
        {"410000", "holding:9999"},
        {"49999", "holding:9998"},
        {"465536", "holding:65535"},
        {"30001", "input:0"},
        {"10020", "discrete:19"},
        {"00020", "coil:19"},
        {"000020", "coil:19"},
        {"holding:0", "holding:0"},
        {"HOLDING:40001", "holding:40001"},
        {"coil:5", "coil:5"},
        {"coil:5:bool", "coil:5"},
        {"discrete:65535", "discrete:65535"},
        {"input:3:float:CDAB", "input:3:float:CDAB"},
        {"Input:3:FLOAT:cdab", "input:3:float:CDAB"},
        {"holding:10.3", "holding:10.3"},
        {"40011.15:bool", "holding:10.15"},
        {"holding:10:bool", "holding:10:bool"},
        {"holding:0:uint16", "holding:0"},
        {"holding:0:int16:BA", "holding:0:int16:BA"},
        {"holding:0:BA", "holding:0:BA"},
        {"holding:0:AB", "holding:0"},
        {"holding:0:text20", "holding:0:text20"},
        {"holding:0:text250:ba", "holding:0:text250:BA"},
        {"holding:65532:double:DCBA", "holding:65532:double:DCBA"},
        {"40001:bcd32:BADC", "holding:0:bcd32:BADC"},
        {"40001:uint64:ABCD", "holding:0:uint64"},
        {"7/40001", "7/holding:0"},
        {"255/coil:1", "255/coil:1"},
    }));
    INFO(row.address);
    CHECK(canonical(row.address) == row.canonical);
}

TEST_CASE("What is no address of Modbus is refused with its place and what was expected")
{
    struct Row {
        std::string_view address;
        std::string_view problem;
    };
    constexpr std::string_view place =
        ", expected a table and an offset from 0, such as holding:0 (or coil, discrete, input), or "
        "a number of five or six digits, such as 40001";
    CHECK(canonical("") == "column 1: found the end" + std::string{place});
    CHECK(canonical("0") == "column 1: found '0'" + std::string{place});
    CHECK(canonical("4001") == "column 1: found '4001'" + std::string{place});
    CHECK(canonical("D100") == "column 1: found 'D100'" + std::string{place});
    CHECK(canonical("7/register:0") == "column 3: found 'register'" + std::string{place});
    const auto row = GENERATE(values<Row>({
        {"20001", "column 1: found '20001', expected 0, 1, 3 or 4 as first digit: coils, discrete "
                  "inputs, input registers, holding registers"},
        {"40000", "column 1: found '40000', expected a table's digit and an item of 1 to 9999"},
        {"465537", "column 1: found '465537', expected a table's digit and an item of 1 to 65536"},
        {"holding", "column 8: found the end, expected ':' and an offset from 0, such as "
                    "holding:0"},
        {"holding:65536", "column 9: found '65536', expected an offset, which is 0 to 65535"},
        {"holding:-1", "column 9: found '-1', expected an offset, which is 0 to 65535"},
        {"holding:", "column 9: found the end, expected an offset, which is 0 to 65535"},
        {"holding:0.16", "column 11: found '16', expected a bit, which is 0 (the lowest) to 15"},
        {"coil:0.1", "column 8: found '1', expected no bit, since coils and discrete inputs are "
                     "bits"},
        {"coil:0:int16", "column 8: found 'int16', expected bool, the only type of coils and "
                         "discrete inputs"},
        {"holding:0.1:int16", "column 13: found 'int16', expected bool, the only type of a bit"},
        {"holding:0:real", "column 11: found 'real', expected a type (bool, int16, uint16, int32, "
                           "uint32, int64, uint64, float, double, bcd16, bcd32, bcd64, text20) or "
                           "an order"},
        {"holding:0:text", "column 11: found 'text', expected the length of a text after its "
                           "type, 1 to 250, such as text20"},
        {"holding:0:text251", "column 11: found 'text251', expected the length of a text after "
                              "its type, 1 to 250, such as text20"},
        {"holding:0:float:BA", "column 17: found 'BA', expected an order: ABCD, CDAB, BADC or "
                               "DCBA"},
        {"holding:0:int16:CDAB", "column 17: found 'CDAB', expected an order of two bytes: AB or "
                                 "BA"},
        {"holding:0.1:bool:AB", "column 18: found 'AB', expected the end, since a bool has no "
                                "order"},
        {"holding:0:float:ABCD:x", "column 17: found 'ABCD:x', expected an order: ABCD, CDAB, "
                                   "BADC or DCBA"},
        {"holding:65535:float", "column 1: found 'holding:65535:float', expected a value that "
                                "ends with register 65535, from 0, at the latest"},
        {"256/coil:0", "column 1: found '256', expected a unit id, which is 0 to 255, before '/'"},
        {"/coil:0", "column 1: found '/', expected a unit id, which is 0 to 255, before '/'"},
        {" 40001", "column 1: found ' 40001', expected a table and an offset from 0, such as "
                   "holding:0 (or coil, discrete, input), or a number of five or six digits, such "
                   "as 40001"},
    }));
    CHECK(canonical(row.address) == row.problem);
}

} // namespace modbus_address_test
