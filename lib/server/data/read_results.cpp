#include "read_results.hpp"

#include <algorithm>

#include "binary/data_value_wire.hpp"

namespace busbar::server::detail {

namespace {

const Variant& value_of(const ReadSlot& slot)
{
    return slot.shared != nullptr ? *slot.shared : slot.value;
}

} // namespace

Timestamps::Timestamps(TimestampsToReturn to_return, DateTime server_time)
    : source{to_return == TimestampsToReturn::Source || to_return == TimestampsToReturn::Both},
      server{to_return == TimestampsToReturn::Server || to_return == TimestampsToReturn::Both
                 ? server_time
                 : DateTime{}}
{
}

Timestamps Timestamps::of_answer(DateTime source_timestamp, DateTime answered) const
{
    Timestamps timestamps = *this;
    if (!server.is_null() && answered > server && source_timestamp > server) {
        timestamps.server = std::min(source_timestamp, answered);
    }
    return timestamps;
}

void encode_slot(binary::Writer& writer, const ReadSlot& slot, const Timestamps& timestamps)
{
    encode_data_value(writer, slot, value_of(slot), timestamps);
}

void encode_data_value(binary::Writer& writer, const DataValue& data, const Variant& value,
                       const Timestamps& timestamps)
{
    const bool has_source = timestamps.source && !data.source_timestamp.is_null();
    busbar::detail::write_data_value(
        writer, {data.status.is_bad() ? nullptr : &value, data.status,
                 has_source ? data.source_timestamp : DateTime{},
                 has_source ? data.source_picoseconds : std::uint16_t{0}, timestamps.server, 0});
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
