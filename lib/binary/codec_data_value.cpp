#include <busbar/binary/codec.hpp>

#include <algorithm>

namespace busbar {

namespace {

// Part 6, 5.2.2.17
constexpr unsigned value_bit = 0x01;
constexpr unsigned status_bit = 0x02;
constexpr unsigned source_timestamp_bit = 0x04;
constexpr unsigned server_timestamp_bit = 0x08;
constexpr unsigned source_picoseconds_bit = 0x10;
constexpr unsigned server_picoseconds_bit = 0x20;
constexpr unsigned all_bits = 0x3F;
constexpr std::uint16_t max_picoseconds = 9'999;

constexpr unsigned bit_if(bool condition, unsigned bit)
{
    return condition ? bit : 0U;
}

unsigned mask_of(const DataValue& value)
{
    return bit_if(!value.value.is_null(), value_bit) |
           bit_if(value.status != StatusCode{}, status_bit) |
           bit_if(!value.source_timestamp.is_null(), source_timestamp_bit) |
           bit_if(!value.server_timestamp.is_null(), server_timestamp_bit) |
           bit_if(value.source_picoseconds != 0, source_picoseconds_bit) |
           bit_if(value.server_picoseconds != 0, server_picoseconds_bit);
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
    if ((mask & value_bit) != 0) {
        encode(writer, value.value);
    }
    if ((mask & status_bit) != 0) {
        encode(writer, value.status);
    }
    if ((mask & source_timestamp_bit) != 0) {
        encode(writer, value.source_timestamp);
    }
    if ((mask & source_picoseconds_bit) != 0) {
        writer.number(std::min(value.source_picoseconds, max_picoseconds));
    }
    if ((mask & server_timestamp_bit) != 0) {
        encode(writer, value.server_timestamp);
    }
    if ((mask & server_picoseconds_bit) != 0) {
        writer.number(std::min(value.server_picoseconds, max_picoseconds));
    }
}

void decode(binary::Reader& reader, DataValue& value)
{
    const unsigned mask = reader.number<std::uint8_t>();
    value = DataValue{};
    if ((mask & ~all_bits) != 0) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    if ((mask & value_bit) != 0) {
        decode(reader, value.value);
    }
    if ((mask & status_bit) != 0) {
        decode(reader, value.status);
    }
    if ((mask & source_timestamp_bit) != 0) {
        decode(reader, value.source_timestamp);
    }
    if ((mask & source_picoseconds_bit) != 0) {
        value.source_picoseconds = decode_picoseconds(reader);
    }
    if ((mask & server_timestamp_bit) != 0) {
        decode(reader, value.server_timestamp);
    }
    if ((mask & server_picoseconds_bit) != 0) {
        value.server_picoseconds = decode_picoseconds(reader);
    }
}

} // namespace busbar
