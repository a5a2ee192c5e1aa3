#include <busbar/binary/codec.hpp>

#include <algorithm>

#include "wire_masks.hpp"

namespace busbar {

namespace {

namespace value_bits = detail::data_value_mask;

constexpr std::uint16_t max_picoseconds = 9'999;

constexpr unsigned bit_if(bool condition, unsigned bit)
{
    return condition ? bit : 0U;
}

unsigned mask_of(const DataValue& value)
{
    return bit_if(!value.value.is_null(), value_bits::value) |
           bit_if(value.status != StatusCode{}, value_bits::status) |
           bit_if(!value.source_timestamp.is_null(), value_bits::source_timestamp) |
           bit_if(!value.server_timestamp.is_null(), value_bits::server_timestamp) |
           bit_if(value.source_picoseconds != 0, value_bits::source_picoseconds) |
           bit_if(value.server_picoseconds != 0, value_bits::server_picoseconds);
}

std::uint16_t decode_picoseconds(binary::Reader& reader)
{
    return std::min(reader.number<std::uint16_t>(), max_picoseconds);
}

} // namespace

void encode(binary::Writer& writer, const DataValue& value)
{
    const unsigned mask = mask_of(value);
    writer.number(static_cast<std::uint8_t>(mask));
    if ((mask & value_bits::value) != 0) {
        encode(writer, value.value);
    }
    if ((mask & value_bits::status) != 0) {
        encode(writer, value.status);
    }
    if ((mask & value_bits::source_timestamp) != 0) {
        encode(writer, value.source_timestamp);
    }
    if ((mask & value_bits::source_picoseconds) != 0) {
        writer.number(std::min(value.source_picoseconds, max_picoseconds));
    }
    if ((mask & value_bits::server_timestamp) != 0) {
        encode(writer, value.server_timestamp);
    }
    if ((mask & value_bits::server_picoseconds) != 0) {
        writer.number(std::min(value.server_picoseconds, max_picoseconds));
    }
}

void decode(binary::Reader& reader, DataValue& value)
{
    const unsigned mask = reader.number<std::uint8_t>();
    value = DataValue{};
    if ((mask & ~value_bits::all) != 0) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    if ((mask & value_bits::value) != 0) {
        decode(reader, value.value);
    }
    if ((mask & value_bits::status) != 0) {
        decode(reader, value.status);
    }
    if ((mask & value_bits::source_timestamp) != 0) {
        decode(reader, value.source_timestamp);
    }
    if ((mask & value_bits::source_picoseconds) != 0) {
        value.source_picoseconds = decode_picoseconds(reader);
    }
    if ((mask & value_bits::server_timestamp) != 0) {
        decode(reader, value.server_timestamp);
    }
    if ((mask & value_bits::server_picoseconds) != 0) {
        value.server_picoseconds = decode_picoseconds(reader);
    }
}

} // namespace busbar
