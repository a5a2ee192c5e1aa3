#include <busbar/backend/modbus_pdu.hpp>

#include <catch2/catch.hpp>

namespace modbus_pdu_test {

using namespace busbar;
using namespace busbar::backend;
using Bytes = std::vector<std::byte>;
using Function = ModbusFunction;

namespace {

ModbusRequest reading(Function function, std::uint16_t address, std::uint16_t quantity)
{
    ModbusRequest request;
    request.function = function;
    request.address = address;
    request.quantity = quantity;
    return request;
}

ModbusRequest writing(Function function, std::uint16_t address, std::size_t count)
{
    ModbusRequest request = reading(function, address, 1);
    request.values.assign(count, 1);
    return request;
}

bool is_sent(const ModbusRequest& request)
{
    Bytes bytes{std::byte{1}};
    const bool is_written = encode_modbus(request, bytes).has_value();
    CHECK((bytes.size() > 1) == is_written);
    CHECK(bytes.size() <= max_modbus_pdu_size + 1);
    return is_written;
}

} // namespace

TEST_CASE("Requests have at most as many items as the protocol allows")
{
    struct Row {
        Function function;
        std::uint16_t max;
    };
    const auto row = GENERATE(values<Row>({{Function::ReadCoils, 2000},
                                           {Function::ReadDiscreteInputs, 2000},
                                           {Function::ReadHoldingRegisters, 125},
                                           {Function::ReadInputRegisters, 125},
                                           {Function::WriteCoils, 1968},
                                           {Function::WriteRegisters, 123}}));
    INFO(static_cast<int>(row.function));
    const auto request = is_write(row.function)
                             ? writing
                             : [](Function f, std::uint16_t address, std::size_t count) {
                                   return reading(f, address, static_cast<std::uint16_t>(count));
                               };
    CHECK(is_sent(request(row.function, 0, row.max)));
    CHECK_FALSE(is_sent(request(row.function, 0, row.max + 1U)));
    CHECK_FALSE(is_sent(request(row.function, 0, 0)));
    CHECK(is_sent(request(row.function, 65535, 1)));
    CHECK_FALSE(is_sent(request(row.function, 65535, 2)));
}

TEST_CASE("What has no place in a request is not sent")
{
    CHECK_FALSE(is_sent(reading(static_cast<Function>(7), 0, 1)));
    CHECK_FALSE(is_sent(writing(Function::WriteRegister, 0, 2)));
    CHECK_FALSE(is_sent(writing(Function::WriteRegister, 0, 0)));
    ModbusRequest coils = writing(Function::WriteCoils, 0, 3);
    coils.values[1] = 2;
    CHECK_FALSE(is_sent(coils));
    ModbusRequest both = writing(Function::ReadWriteRegisters, 0, 121);
    both.quantity = 125;
    CHECK(is_sent(both));
    both.values.push_back(0);
    CHECK_FALSE(is_sent(both));
    ModbusRequest identification;
    identification.function = Function::ReadDeviceIdentification;
    CHECK(is_sent(identification));
    identification.read_code = 5;
    CHECK_FALSE(is_sent(identification));
}

TEST_CASE("A response to another request is not taken")
{
    const ModbusRequest asked = writing(Function::WriteRegister, 5, 1);
    Bytes pdu;
    REQUIRE(encode_modbus(writing(Function::WriteRegister, 6, 1), ModbusResponse{}, pdu));
    CHECK(parse_modbus_response(asked, pdu).error() == status::Bad_UnknownResponse);
    pdu.clear();
    REQUIRE(encode_modbus(asked, ModbusResponse{}, pdu));
    CHECK(parse_modbus_response(asked, pdu));
    CHECK_FALSE(parse_modbus_response(reading(Function::ReadCoils, 5, 1), pdu));

    // As many values as were not requested are not written either.
    ModbusResponse two;
    two.values = {1, 2};
    CHECK(encode_modbus(reading(Function::ReadHoldingRegisters, 0, 3), two, pdu).error() ==
          status::Bad_OutOfRange);
}

TEST_CASE("An identification that does not fit names the object to go on with")
{
    ModbusRequest asked;
    asked.function = Function::ReadDeviceIdentification;
    ModbusResponse response;
    response.function = asked.function;
    response.identification.objects = {{0, std::string(200, 'a')}, {1, std::string(60, 'b')}};
    Bytes pdu;
    REQUIRE(encode_modbus(asked, response, pdu));
    CHECK(pdu.size() <= max_modbus_pdu_size);
    const auto parsed = parse_modbus_response(asked, pdu);
    REQUIRE(parsed);
    CHECK(parsed->identification.next == 1);
    CHECK(parsed->identification.objects.size() == 1);
}

TEST_CASE("A header of another protocol or length is refused as soon as it is there")
{
    struct Row {
        std::vector<unsigned> bytes;
        bool is_valid;
    };
    const auto row = GENERATE(values<Row>({{{0, 1, 0, 0, 0, 2, 1}, true},
                                           {{0, 1, 0, 0, 0, 254, 1}, true},
                                           {{0, 1, 0, 0, 0, 1, 1}, false},
                                           {{0, 1, 0, 0, 0, 0, 1}, false},
                                           {{0, 1, 0, 0, 0, 255}, false},
                                           {{0, 1, 0, 0, 255, 255, 1}, false},
                                           {{0, 1, 18, 52}, false},
                                           {{0, 1, 0, 1}, false}}));
    Bytes bytes;
    for (const unsigned byte : row.bytes) {
        bytes.push_back(static_cast<std::byte>(byte));
    }
    CHECK(parse_modbus_header(bytes).has_value() == row.is_valid);
}

TEST_CASE("An exception has a status, and says whether the same request makes sense later")
{
    const auto status_of_read = [](int code) {
        return status_of(static_cast<ModbusException>(code), Function::ReadCoils);
    };
    CHECK(status_of_read(1) == status::Bad_NotSupported);
    CHECK(status_of_read(2) == status::Bad_ConfigurationError);
    CHECK(status_of_read(3) == status::Bad_OutOfRange);
    CHECK(status_of_read(4) == status::Bad_DeviceFailure);
    CHECK(status_of_read(5) == status::Bad_ResourceUnavailable);
    CHECK(status_of(ModbusException::Acknowledge, Function::WriteCoil) ==
          status::Good_CompletesAsynchronously);
    CHECK(status_of_read(6) == status::Bad_ResourceUnavailable);
    CHECK(status_of_read(11) == status::Bad_NoCommunication);
    CHECK(status_of_read(0) == status::Bad_UnknownResponse);
    CHECK(status_of_read(99) == status::Bad_UnknownResponse);
    CHECK(is_refusal(ModbusException::IllegalDataAddress));
    CHECK_FALSE(is_refusal(ModbusException::DeviceBusy));
    CHECK(text_of(ModbusException::IllegalDataAddress) == "exception 2 (address not available)");
    CHECK(text_of(static_cast<ModbusException>(77)) == "exception 77 (not defined)");
}

} // namespace modbus_pdu_test
