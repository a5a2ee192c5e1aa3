#pragma once

#include <busbar/binary/writer.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::server::detail {

/// Which timestamps the client wants (Part 4, 7.40) and the server's own.
struct Timestamps {
    Timestamps(TimestampsToReturn to_return, DateTime server_time);

    /// For a value that a source was asked for at `server` and gave by `answered`: the source's
    /// time if that was meanwhile, so that both timestamps are the same (Part 4, 7.11.1: when the
    /// server received the value). A source's clock may be another one.
    [[nodiscard]] Timestamps of_answer(DateTime source_timestamp, DateTime answered) const;

    bool source;
    /// Zero if it is not wanted.
    DateTime server;
};

/// Writes a slot as the DataValue of a response: without value if the status is bad (Part 4,
/// 7.11.1), with the timestamps that are wanted.
void encode_slot(binary::Writer& writer, const ReadSlot& slot, const Timestamps& timestamps);

/// The same for `value` with the rest from `data`.
void encode_data_value(binary::Writer& writer, const DataValue& data, const Variant& value,
                       const Timestamps& timestamps);

/// Replaces the slot's value by the part of it that `range` names.
void cut_range(ReadSlot& slot, const NumericRange& range);

} // namespace busbar::server::detail
