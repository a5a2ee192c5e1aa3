#include <busbar/harness/modbus_responder.hpp>

#include <algorithm>

namespace busbar::harness {

namespace {

using backend::ModbusException;
using backend::ModbusFunction;
using backend::ModbusRequest;
using backend::ModbusResponse;
using backend::ModbusTable;

constexpr std::uint8_t single_object = 4;
/// The last objects of read codes 1 to 3 (6.21).
constexpr std::array<std::uint8_t, 3> last_objects{0x02, 0x7F, 0xFF};

[[nodiscard]] ModbusTable table_of(ModbusFunction function)
{
    switch (function) {
    case ModbusFunction::ReadCoils:
    case ModbusFunction::WriteCoil:
    case ModbusFunction::WriteCoils:
        return ModbusTable::Coil;
    case ModbusFunction::ReadDiscreteInputs:
        return ModbusTable::DiscreteInput;
    case ModbusFunction::ReadInputRegisters:
        return ModbusTable::InputRegister;
    default:
        return ModbusTable::HoldingRegister;
    }
}

[[nodiscard]] bool is_read(ModbusFunction function)
{
    return !is_write(function) || function == ModbusFunction::ReadWriteRegisters;
}

[[nodiscard]] ModbusResponse refusal(const ModbusRequest& request, ModbusException exception)
{
    ModbusResponse response;
    response.function = request.function;
    response.exception = exception;
    return response;
}

} // namespace

ModbusDevice::ModbusDevice(ModbusDeviceOptions options) : options_{std::move(options)}
{
    for (std::size_t i = 0; i < tables_.size(); ++i) {
        tables_[i].resize(std::min<std::size_t>(options_.sizes[i], 0x1'0000));
    }
}

std::span<std::uint16_t> ModbusDevice::table(ModbusTable table)
{
    return tables_[static_cast<std::size_t>(table)];
}

void ModbusDevice::refuse(ModbusTable table, std::size_t first, std::size_t count,
                          ModbusException exception)
{
    refused_.push_back({table, first, count, exception});
}

std::optional<ModbusFault> ModbusDevice::next_fault()
{
    if (faults_.empty()) {
        return std::nullopt;
    }
    if (faults_.front().after != 0) {
        --faults_.front().after;
        return std::nullopt;
    }
    const ModbusFault fault = faults_.front();
    faults_.pop_front();
    return fault;
}

std::optional<std::vector<std::byte>> ModbusDevice::answer(std::uint8_t unit,
                                                           std::span<const std::byte> pdu)
{
    const auto parsed = backend::parse_modbus_request(pdu);
    ModbusRequest request;
    if (parsed) {
        request = *parsed;
    } else {
        // The answer names the function that was requested, whether there is one or not.
        request.function =
            static_cast<ModbusFunction>(pdu.empty() ? 0 : std::to_integer<unsigned>(pdu[0]));
    }
    const bool has_unit =
        options_.units.empty() || std::ranges::find(options_.units, unit) != options_.units.end();
    const bool is_broadcast = !options_.units.empty() && unit == 0;
    if (!has_unit && !is_broadcast && !options_.answers_for_missing_units) {
        return std::nullopt;
    }
    ModbusResponse response;
    if (!has_unit && !is_broadcast) {
        response = refusal(request, ModbusException::GatewayTargetSilent);
    } else {
        response = parsed ? execute(request) : refusal(request, parsed.error());
    }
    std::vector<std::byte> bytes;
    if (is_broadcast || !encode_modbus(request, response, bytes)) {
        return std::nullopt;
    }
    return bytes;
}

std::optional<ModbusException> ModbusDevice::why_not(ModbusTable table, std::size_t first,
                                                     std::size_t count) const
{
    if (!has_bits(table) && count > options_.max_registers) {
        return ModbusException::IllegalDataValue;
    }
    if (first + count > tables_[static_cast<std::size_t>(table)].size()) {
        return ModbusException::IllegalDataAddress;
    }
    const auto hit = std::ranges::find_if(refused_, [&](const Refused& refused) {
        return refused.table == table && first < refused.first + refused.count &&
               refused.first < first + count;
    });
    return hit == refused_.end() ? std::nullopt : std::optional{hit->exception};
}

ModbusResponse ModbusDevice::execute(const ModbusRequest& request)
{
    if (std::ranges::find(options_.missing_functions, request.function) !=
        options_.missing_functions.end()) {
        return refusal(request, ModbusException::IllegalFunction);
    }
    if (request.function == ModbusFunction::ReadDeviceIdentification) {
        return identify(request);
    }
    const ModbusTable place = table_of(request.function);
    const bool reads = is_read(request.function);
    const std::size_t to_write = reads ? request.write_address : std::size_t{request.address};
    const bool is_mask = request.function == ModbusFunction::MaskWriteRegister;
    const std::size_t written = is_mask ? 1 : request.values.size();
    auto problem = reads ? why_not(place, request.address, request.quantity) : std::nullopt;
    if (!problem && is_write(request.function)) {
        problem = why_not(place, to_write, written);
    }
    if (problem) {
        return refusal(request, *problem);
    }
    ++executed_;
    const std::span<std::uint16_t> items = table(place);
    if (is_mask) {
        const unsigned old = items[to_write];
        const unsigned mask = request.and_mask;
        items[to_write] = static_cast<std::uint16_t>((old & mask) | (request.or_mask & ~mask));
    } else if (is_write(request.function)) {
        std::ranges::copy(request.values, items.subspan(to_write).begin());
    }
    ModbusResponse response;
    response.function = request.function;
    if (reads) {
        const auto part = items.subspan(request.address, request.quantity);
        response.values.assign(part.begin(), part.end());
    }
    return response;
}

ModbusResponse ModbusDevice::identify(const ModbusRequest& request) const
{
    ModbusResponse response;
    response.function = request.function;
    response.identification.read_code = request.read_code;
    response.identification.conformity = options_.conformity;
    const bool is_single = request.read_code == single_object;
    const std::uint8_t last =
        is_single ? request.object : last_objects[request.read_code - std::size_t{1}];
    // With an object that it has not, a stream begins again (6.21).
    const bool has_object =
        std::ranges::find(options_.objects, request.object,
                          &backend::ModbusIdentification::Object::id) != options_.objects.end();
    if (is_single && !has_object) {
        return refusal(request, ModbusException::IllegalDataAddress);
    }
    const std::uint8_t first = has_object ? request.object : std::uint8_t{0};
    for (const auto& object : options_.objects) {
        if (object.id >= first && object.id <= last) {
            response.identification.objects.push_back(object);
        }
    }
    return response;
}

} // namespace busbar::harness
