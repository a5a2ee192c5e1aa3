#include <catch2/catch.hpp>

#include <busbar/backend/modbus_client.hpp>
#include <busbar/harness/modbus_responder.hpp>

#include "modbus_rows.hpp"

namespace modbus_engine_rows_test {

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

namespace {

constexpr TimePoint now{1s};

Bytes of(std::span<const std::byte> bytes)
{
    return {bytes.begin(), bytes.end()};
}

/// The frame with another transaction, which each client numbers by itself.
Bytes with_transaction(Bytes frame, std::span<const std::byte> other)
{
    std::copy_n(other.begin(), 2, frame.begin());
    return frame;
}

ModbusTable table_of(ModbusFunction function)
{
    const auto code = static_cast<int>(function);
    return code == 1 || code == 5 || code == 15 ? ModbusTable::Coil
           : code == 2                          ? ModbusTable::DiscreteInput
           : code == 4                          ? ModbusTable::InputRegister
                                                : ModbusTable::HoldingRegister;
}

/// A device that has what the row's device must have had.
harness::ModbusDevice device_for(const test::ModbusRow& row)
{
    harness::ModbusDeviceOptions options;
    options.conformity = row.answered.identification.conformity;
    options.objects = row.answered.identification.objects;
    const auto exception = row.answered.exception;
    if (exception == ModbusException::GatewayTargetSilent) {
        options.units = {1};
    }
    harness::ModbusDevice device{options};
    const ModbusTable table = table_of(row.asked.function);
    std::ranges::copy(row.answered.values, device.table(table).subspan(row.asked.address).begin());
    if (!row.is_refused && exception && options.units.empty()) {
        device.refuse(table, row.asked.address, 1, *exception);
    }
    return device;
}

} // namespace

TEST_CASE("A client sends the requests of other implementations and takes their responses")
{
    std::size_t count = 0;
    for (const test::ModbusRow& row : test::modbus_rows()) {
        INFO(row.name);
        ModbusClient client{{}};
        const auto id = client.send(row.asked, row.unit, now);
        if (!id) {
            CHECK(row.is_refused);
            continue;
        }
        if (!row.is_refused) {
            CHECK(of(client.output()) == with_transaction(row.request, client.output()));
        }
        REQUIRE(client.feed(with_transaction(row.response, client.output()), now));
        const auto event = client.next_event();
        REQUIRE(event);
        CHECK(event->id == *id);
        CHECK(event->answer == row.answered);
        CHECK(event->status.is_good() == !row.answered.exception);
        ++count;
    }
    CHECK(count == 34);
}

TEST_CASE("A responder answers the requests of other implementations byte for byte")
{
    for (const test::ModbusRow& row : test::modbus_rows()) {
        INFO(row.name);
        harness::ModbusDevice device = device_for(row);
        harness::ModbusResponder responder{device};
        // Whole, and in single bytes.
        REQUIRE(responder.feed(row.request, now));
        CHECK(of(responder.output()) == row.response);
        responder.consume(row.response.size());
        for (const std::byte byte : row.request) {
            REQUIRE(responder.feed({&byte, 1}, now));
        }
        CHECK(of(responder.output()) == row.response);
        if (row.answered.exception) {
            continue;
        }
        const auto first = row.asked.function == ModbusFunction::ReadWriteRegisters
                               ? row.asked.write_address
                               : row.asked.address;
        const auto items = device.table(table_of(row.asked.function)).subspan(first);
        CHECK(std::ranges::equal(row.asked.values, items.first(row.asked.values.size())));
    }
}

} // namespace modbus_engine_rows_test
