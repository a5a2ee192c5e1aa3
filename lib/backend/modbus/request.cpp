#include <algorithm>

#include <busbar/backend/modbus_pdu.hpp>

#include "wire.hpp"

namespace busbar::backend {

namespace {

using detail::ModbusForm;
using detail::ModbusReader;
using detail::ModbusWriter;

constexpr std::uint8_t last_read_code = 4;

[[nodiscard]] bool fits(std::size_t address, std::size_t count, std::size_t max)
{
    return count != 0 && count <= max && address + count <= detail::end_of_modbus_items;
}

/// True if the request is one that the protocol allows.
[[nodiscard]] bool is_allowed(const ModbusRequest& request, const ModbusForm& form)
{
    if (request.function == ModbusFunction::ReadDeviceIdentification) {
        return request.read_code >= 1 && request.read_code <= last_read_code;
    }
    const bool reads = form.max_read != 0;
    if (reads && !fits(request.address, request.quantity, form.max_read)) {
        return false;
    }
    if (form.max_write == 0) {
        return true;
    }
    return fits(reads ? request.write_address : request.address, request.values.size(),
                form.max_write) &&
           (!form.has_bits || std::ranges::all_of(request.values, [](auto v) { return v <= 1; }));
}

void write_items(const ModbusRequest& request, const ModbusForm& form, ModbusWriter& writer)
{
    const std::size_t count = request.values.size();
    writer.word(count);
    writer.byte(form.has_bits ? (count + 7) / 8 : 2 * count);
    if (form.has_bits) {
        writer.bits(request.values);
    } else {
        writer.words(request.values);
    }
}

void write_body(const ModbusRequest& request, const ModbusForm& form, ModbusWriter& writer)
{
    writer.word(request.address);
    if (form.is_single) {
        const std::uint16_t value = request.values[0];
        const std::uint16_t coil = value != 0 ? detail::coil_on : std::uint16_t{0};
        writer.word(form.has_bits ? coil : value);
        return;
    }
    if (request.function == ModbusFunction::MaskWriteRegister) {
        writer.word(request.and_mask);
        writer.word(request.or_mask);
        return;
    }
    if (form.max_read != 0) {
        writer.word(request.quantity);
    }
    if (form.max_read != 0 && form.max_write != 0) {
        writer.word(request.write_address);
    }
    if (form.max_write != 0) {
        write_items(request, form, writer);
    }
}

/// False for what must be answered by IllegalDataValue.
[[nodiscard]] bool read_items(ModbusReader& reader, const ModbusForm& form, ModbusRequest& request)
{
    const std::size_t count = reader.word();
    const std::size_t size = reader.byte();
    if (count == 0 || count > form.max_write ||
        size != (form.has_bits ? (count + 7) / 8 : 2 * count)) {
        return false;
    }
    request.values = form.has_bits ? reader.bits(count) : reader.words(count);
    return true;
}

[[nodiscard]] bool read_single(ModbusReader& reader, const ModbusForm& form, ModbusRequest& request)
{
    const std::uint16_t value = reader.word();
    if (form.has_bits && value != 0 && value != detail::coil_on) {
        return false;
    }
    request.values = {form.has_bits ? static_cast<std::uint16_t>(value != 0 ? 1 : 0) : value};
    return true;
}

[[nodiscard]] bool read_body(ModbusReader& reader, const ModbusForm& form, ModbusRequest& request)
{
    request.address = reader.word();
    if (form.is_single) {
        return read_single(reader, form, request);
    }
    if (request.function == ModbusFunction::MaskWriteRegister) {
        request.and_mask = reader.word();
        request.or_mask = reader.word();
        return true;
    }
    if (form.max_read != 0) {
        request.quantity = reader.word();
        if (request.quantity == 0 || request.quantity > form.max_read) {
            return false;
        }
    }
    if (form.max_read != 0 && form.max_write != 0) {
        request.write_address = reader.word();
    }
    return form.max_write == 0 || read_items(reader, form, request);
}

} // namespace

Result<void> encode_modbus(const ModbusRequest& request, std::vector<std::byte>& out)
{
    const auto code = static_cast<std::uint8_t>(request.function);
    const ModbusForm* const form = detail::modbus_form(code);
    if (form == nullptr || !is_allowed(request, *form)) {
        return fail(status::Bad_OutOfRange);
    }
    ModbusWriter writer{out};
    writer.byte(code);
    if (request.function == ModbusFunction::ReadDeviceIdentification) {
        writer.byte(detail::identification_mei);
        writer.byte(request.read_code);
        writer.byte(request.object);
    } else {
        write_body(request, *form, writer);
    }
    return {};
}

Expected<ModbusRequest, ModbusException> parse_modbus_request(std::span<const std::byte> pdu)
{
    ModbusReader reader{pdu};
    const std::uint8_t code = reader.byte();
    const ModbusForm* const form = detail::modbus_form(code);
    if (form == nullptr) {
        return Unexpected{ModbusException::IllegalFunction};
    }
    ModbusRequest request;
    request.function = form->function;
    bool is_valid = false;
    if (request.function == ModbusFunction::ReadDeviceIdentification) {
        if (reader.byte() != detail::identification_mei) {
            return Unexpected{ModbusException::IllegalFunction};
        }
        request.read_code = reader.byte();
        request.object = reader.byte();
        is_valid = request.read_code >= 1 && request.read_code <= last_read_code;
    } else {
        is_valid = read_body(reader, *form, request);
    }
    if (!is_valid || !reader.is_done()) {
        return Unexpected{ModbusException::IllegalDataValue};
    }
    return request;
}

} // namespace busbar::backend
