#include <busbar/binary/codec.hpp>

#include <algorithm>

#include "data_value_wire.hpp"

namespace busbar {

namespace {

std::uint16_t decode_picoseconds(binary::Reader& reader)
{
    return std::min(reader.number<std::uint16_t>(), detail::max_picoseconds);
}

} // namespace

void encode(binary::Writer& writer, const DataValue& value)
{
    detail::write_data_value(writer, {&value.value, value.status, value.source_timestamp,
                                      value.source_picoseconds, value.server_timestamp,
                                      value.server_picoseconds});
}

void decode(binary::Reader& reader, DataValue& value)
{
    namespace bits = detail::data_value_mask;
    value = DataValue{};
    detail::read_data_value(reader, [&](auto bit) {
        using Bit = decltype(bit);
        if constexpr (std::is_same_v<Bit, bits::Value>) {
            decode(reader, value.value);
        } else if constexpr (std::is_same_v<Bit, bits::Status>) {
            decode(reader, value.status);
        } else if constexpr (std::is_same_v<Bit, bits::SourceTimestamp>) {
            decode(reader, value.source_timestamp);
        } else if constexpr (std::is_same_v<Bit, bits::SourcePicoseconds>) {
            value.source_picoseconds = decode_picoseconds(reader);
        } else if constexpr (std::is_same_v<Bit, bits::ServerTimestamp>) {
            decode(reader, value.server_timestamp);
        } else {
            value.server_picoseconds = decode_picoseconds(reader);
        }
    });
}

} // namespace busbar
