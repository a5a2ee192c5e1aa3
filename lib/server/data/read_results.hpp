#pragma once

#include <busbar/binary/writer.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::server::detail {

/// The timestamps that the client requests (Part 4, 7.40) and the server's own.
struct Timestamps {
    Timestamps(TimestampsToReturn to_return, DateTime server_time);

    /// Returns the timestamps of a value that was requested from a source at `server` and returned
    /// by `answered`: the source's time if it is in between, so that both timestamps are equal
    /// (Part 4, 7.11.1: the time when the server received the value). A source's clock may differ.
    [[nodiscard]] Timestamps of_answer(DateTime source_timestamp, DateTime answered) const;

    bool source;
    /// Zero if it is not requested.
    DateTime server;
};

/// Returns whether each text in `value`, also in structures, is UTF-8 (Part 6, 5.2.2.4); a
/// structure that is encoded already is not looked into. A text that is not would cost the client
/// that gets it the whole response.
[[nodiscard]] bool has_valid_texts(const Variant& value);

/// Returns the status with which a response has the slot: Bad_EncodingError for a value with a text
/// that is not UTF-8.
[[nodiscard]] StatusCode served_status(const ReadSlot& slot);

/// Writes a slot as the DataValue of a response: without value if the status is bad (Part 4,
/// 7.11.1), with the requested timestamps. Returns served_status().
StatusCode encode_slot(binary::Writer& writer, const ReadSlot& slot, const Timestamps& timestamps);

/// Writes `value` likewise, with the other fields of `data`, and returns the status that it wrote.
StatusCode encode_data_value(binary::Writer& writer, const DataValue& data, const Variant& value,
                             const Timestamps& timestamps);

/// Replaces the slot's value by the part of it that `range` selects.
void cut_range(ReadSlot& slot, const NumericRange& range);

} // namespace busbar::server::detail
