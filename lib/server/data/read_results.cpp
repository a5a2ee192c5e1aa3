#include "read_results.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>

namespace busbar::server::detail {

namespace {

// Part 6, 5.2.2.17
constexpr unsigned value_bit = 0x01;
constexpr unsigned status_bit = 0x02;
constexpr unsigned source_timestamp_bit = 0x04;
constexpr unsigned server_timestamp_bit = 0x08;
constexpr unsigned source_picoseconds_bit = 0x10;
constexpr std::uint16_t max_picoseconds = 9'999;

const Variant& value_of(const ReadSlot& slot)
{
    return slot.shared != nullptr ? *slot.shared : slot.value;
}

unsigned mask_of(const DataValue& data, const Variant& value, const Timestamps& timestamps)
{
    unsigned mask = 0;
    if (!data.status.is_bad() && !value.is_null()) {
        mask |= value_bit;
    }
    if (data.status != StatusCode{}) {
        mask |= status_bit;
    }
    if (timestamps.source && !data.source_timestamp.is_null()) {
        mask |= source_timestamp_bit;
        mask |= data.source_picoseconds != 0 ? source_picoseconds_bit : 0U;
    }
    if (!timestamps.server.is_null()) {
        mask |= server_timestamp_bit;
    }
    return mask;
}

} // namespace

Timestamps::Timestamps(TimestampsToReturn to_return, DateTime server_time)
    : source{to_return == TimestampsToReturn::Source || to_return == TimestampsToReturn::Both},
      server{to_return == TimestampsToReturn::Server || to_return == TimestampsToReturn::Both
                 ? server_time
                 : DateTime{}}
{
}

void encode_slot(binary::Writer& writer, const ReadSlot& slot, const Timestamps& timestamps)
{
    encode_data_value(writer, slot, value_of(slot), timestamps);
}

void encode_data_value(binary::Writer& writer, const DataValue& data, const Variant& value,
                       const Timestamps& timestamps)
{
    const unsigned mask = mask_of(data, value, timestamps);
    writer.number(static_cast<std::uint8_t>(mask));
    if ((mask & value_bit) != 0) {
        encode(writer, value);
    }
    if ((mask & status_bit) != 0) {
        encode(writer, data.status);
    }
    if ((mask & source_timestamp_bit) != 0) {
        encode(writer, data.source_timestamp);
    }
    if ((mask & source_picoseconds_bit) != 0) {
        writer.number(std::min(data.source_picoseconds, max_picoseconds));
    }
    if ((mask & server_timestamp_bit) != 0) {
        encode(writer, timestamps.server);
    }
}

void cut_range(ReadSlot& slot, const NumericRange& range)
{
    if (slot.status.is_bad()) {
        return;
    }
    Result<Variant> part = read_range(value_of(slot), range);
    if (part) {
        slot.value = std::move(*part);
        slot.shared = nullptr;
    } else {
        slot.status = part.error();
    }
}

} // namespace busbar::server::detail
