#include <catch2/catch.hpp>

#include "modbus_rows.hpp"

namespace modbus_vector_test {

using namespace busbar;
using namespace busbar::backend;
using Bytes = std::vector<std::byte>;

namespace {

Bytes frame(const test::ModbusRow& row, const Bytes& pdu)
{
    Bytes bytes;
    encode_modbus(ModbusHeader{row.transaction, row.unit, pdu.size()}, bytes);
    bytes.insert(bytes.end(), pdu.begin(), pdu.end());
    return bytes;
}

std::span<const std::byte> pdu_of(const Bytes& frame)
{
    return std::span{frame}.subspan(modbus_header_size);
}

} // namespace

TEST_CASE("The requests of other implementations are written and read byte for byte")
{
    const auto rows = test::modbus_rows();
    REQUIRE(rows.size() == 39);
    std::size_t refused = 0;
    for (const test::ModbusRow& row : rows) {
        INFO(row.name);
        const auto header = parse_modbus_header(row.request);
        REQUIRE(header);
        REQUIRE(*header);
        CHECK(**header ==
              ModbusHeader{row.transaction, row.unit, row.request.size() - modbus_header_size});
        const auto parsed = parse_modbus_request(pdu_of(row.request));
        if (row.is_refused) {
            ++refused;
            // That an address does not exist is for the device to say.
            CHECK((parsed ? ModbusException::IllegalDataAddress : parsed.error()) ==
                  row.answered.exception);
            continue;
        }
        REQUIRE(parsed);
        CHECK(*parsed == row.asked);
        Bytes pdu;
        REQUIRE(encode_modbus(row.asked, pdu));
        CHECK(frame(row, pdu) == row.request);
    }
    CHECK(refused == 6);
}

TEST_CASE("The responses of other implementations are written and read byte for byte")
{
    for (const test::ModbusRow& row : test::modbus_rows()) {
        INFO(row.name);
        const auto parsed = parse_modbus_response(row.asked, pdu_of(row.response));
        REQUIRE(parsed);
        CHECK(*parsed == row.answered);
        Bytes pdu;
        REQUIRE(encode_modbus(row.asked, row.answered, pdu));
        CHECK(frame(row, pdu) == row.response);
    }
}

TEST_CASE("A request or response that is cut, or has something after it, is not taken for a whole")
{
    for (const test::ModbusRow& row : test::modbus_rows()) {
        INFO(row.name);
        const auto request = pdu_of(row.request);
        const auto response = pdu_of(row.response);
        for (std::size_t size = 1; size < response.size(); ++size) {
            CHECK_FALSE(parse_modbus_response(row.asked, response.first(size)));
        }
        for (std::size_t size = 1; size < request.size(); ++size) {
            CHECK_FALSE(parse_modbus_request(request.first(size)));
        }
        for (std::size_t size = 0; size < modbus_header_size; ++size) {
            const auto header = parse_modbus_header(std::span{row.request}.first(size));
            REQUIRE(header);
            CHECK_FALSE(*header);
        }
        Bytes longer{response.begin(), response.end()};
        longer.push_back(std::byte{0});
        CHECK_FALSE(parse_modbus_response(row.asked, longer));
        longer.assign(request.begin(), request.end());
        longer.push_back(std::byte{0});
        CHECK_FALSE(parse_modbus_request(longer));
    }
}

} // namespace modbus_vector_test
