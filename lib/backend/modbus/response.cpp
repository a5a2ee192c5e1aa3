#include <algorithm>

#include <busbar/backend/modbus_pdu.hpp>

#include "wire.hpp"

namespace busbar::backend {

namespace {

using detail::ModbusForm;
using detail::ModbusReader;
using detail::ModbusWriter;

/// Size of an identification before its objects (6.21).
constexpr std::size_t identification_head_size = 7;
constexpr std::size_t object_head_size = 2;
constexpr std::uint8_t more_follows = 0xFF;

void write_identification(const ModbusIdentification& identification, ModbusWriter& writer)
{
    writer.byte(detail::identification_mei);
    writer.byte(identification.read_code);
    writer.byte(identification.conformity);
    writer.byte(identification.next ? more_follows : 0);
    writer.byte(identification.next.value_or(0));
    writer.byte(0);
    std::size_t count = 0;
    for (const ModbusIdentification::Object& object : identification.objects) {
        if (writer.size() + object_head_size + object.value.size() > max_modbus_pdu_size) {
            writer.replace(identification_head_size - 3, more_follows);
            writer.replace(identification_head_size - 2, object.id);
            break;
        }
        writer.byte(object.id);
        writer.byte(object.value.size());
        writer.text(object.value);
        ++count;
    }
    writer.replace(identification_head_size - 1, count);
}

/// Writes the part of a request that the response to a pure write repeats, from the address on.
void write_echo(const ModbusRequest& asked, const ModbusForm& form, ModbusWriter& writer)
{
    writer.word(asked.address);
    if (asked.function == ModbusFunction::MaskWriteRegister) {
        writer.word(asked.and_mask);
        writer.word(asked.or_mask);
    } else if (form.is_single) {
        const std::uint16_t value = asked.values.empty() ? std::uint16_t{0} : asked.values[0];
        const std::uint16_t coil = value != 0 ? detail::coil_on : std::uint16_t{0};
        writer.word(form.has_bits ? coil : value);
    } else {
        writer.word(asked.values.size());
    }
}

[[nodiscard]] Result<ModbusIdentification> read_identification(ModbusReader& reader,
                                                               const ModbusRequest& asked)
{
    const bool is_known_type = reader.byte() == detail::identification_mei;
    ModbusIdentification identification;
    identification.read_code = reader.byte();
    identification.conformity = reader.byte();
    const std::uint8_t more = reader.byte();
    const std::uint8_t next = reader.byte();
    if (more == more_follows) {
        identification.next = next;
    }
    const std::size_t count = reader.byte();
    for (std::size_t i = 0; i < count && reader.left() != 0; ++i) {
        ModbusIdentification::Object object;
        object.id = reader.byte();
        object.value = reader.text(reader.byte());
        identification.objects.push_back(std::move(object));
    }
    if (!is_known_type || identification.read_code != asked.read_code ||
        (more != 0 && more != more_follows) || !reader.is_done() ||
        identification.objects.size() != count) {
        return fail(status::Bad_UnknownResponse);
    }
    return identification;
}

[[nodiscard]] bool read_values(ModbusReader& reader, const ModbusRequest& asked,
                               const ModbusForm& form, ModbusResponse& response)
{
    const std::size_t count = asked.quantity;
    if (reader.byte() != (form.has_bits ? (count + 7) / 8 : 2 * count)) {
        return false;
    }
    response.values = form.has_bits ? reader.bits(count) : reader.words(count);
    return reader.is_done();
}

} // namespace

Result<void> encode_modbus(const ModbusRequest& asked, const ModbusResponse& response,
                           std::vector<std::byte>& out)
{
    const auto code = static_cast<std::uint8_t>(asked.function);
    ModbusWriter writer{out};
    if (response.exception) {
        writer.byte(code | detail::exception_bit);
        writer.byte(static_cast<std::uint8_t>(*response.exception));
        return {};
    }
    const ModbusForm* const form = detail::modbus_form(code);
    if (form == nullptr || (form->max_read != 0 && (response.values.size() != asked.quantity ||
                                                    asked.quantity > form->max_read))) {
        return fail(status::Bad_OutOfRange);
    }
    writer.byte(code);
    if (asked.function == ModbusFunction::ReadDeviceIdentification) {
        write_identification(response.identification, writer);
    } else if (form->max_read == 0) {
        write_echo(asked, *form, writer);
    } else if (form->has_bits) {
        writer.byte((response.values.size() + 7) / 8);
        writer.bits(response.values);
    } else {
        writer.byte(2 * response.values.size());
        writer.words(response.values);
    }
    return {};
}

Result<ModbusResponse> parse_modbus_response(const ModbusRequest& asked,
                                             std::span<const std::byte> pdu)
{
    const auto code = static_cast<std::uint8_t>(asked.function);
    const ModbusForm* const form = detail::modbus_form(code);
    ModbusReader reader{pdu};
    const std::uint8_t answered = reader.byte();
    ModbusResponse response;
    response.function = asked.function;
    if (answered == (code | detail::exception_bit)) {
        response.exception = static_cast<ModbusException>(reader.byte());
        return reader.is_done() ? Result<ModbusResponse>{std::move(response)}
                                : fail(status::Bad_UnknownResponse);
    }
    bool is_right = form != nullptr && answered == code;
    if (is_right && asked.function == ModbusFunction::ReadDeviceIdentification) {
        auto identification = read_identification(reader, asked);
        is_right = identification.has_value();
        if (is_right) {
            response.identification = std::move(*identification);
        }
    } else if (is_right && form->max_read != 0) {
        is_right = read_values(reader, asked, *form, response);
    } else if (is_right) {
        std::vector<std::byte> echo;
        ModbusWriter writer{echo};
        writer.byte(code);
        write_echo(asked, *form, writer);
        is_right = std::ranges::equal(echo, pdu);
    }
    return is_right ? Result<ModbusResponse>{std::move(response)}
                    : fail(status::Bad_UnknownResponse);
}

void encode_modbus(const ModbusHeader& header, std::vector<std::byte>& out)
{
    ModbusWriter writer{out};
    writer.word(header.transaction);
    writer.word(0);
    writer.word(header.pdu_size + 1);
    writer.byte(header.unit);
}

Result<std::optional<ModbusHeader>> parse_modbus_header(std::span<const std::byte> bytes)
{
    constexpr std::size_t end_of_length = 6;
    ModbusReader reader{bytes.first(std::min(bytes.size(), modbus_header_size))};
    ModbusHeader header;
    header.transaction = reader.word();
    const std::uint16_t protocol = reader.word();
    const std::size_t length = reader.word();
    header.unit = reader.byte();
    if (protocol != 0 ||
        (bytes.size() >= end_of_length && (length < 2 || length > max_modbus_pdu_size + 1))) {
        return fail(status::Bad_DecodingError);
    }
    if (bytes.size() < modbus_header_size) {
        return std::optional<ModbusHeader>{};
    }
    header.pdu_size = length - 1;
    return std::optional{header};
}

} // namespace busbar::backend
