#pragma once

#include <cstdint>

#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// DataValue (Part 4, 7.11; Part 6, 5.2.2.17): a value with status and timestamps. A timestamp of 0
/// and a Good status are not encoded. Picoseconds are in units of 10 ps, 0 to 9,999.
struct DataValue {
    Variant value;
    StatusCode status;
    std::uint16_t source_picoseconds{0};
    std::uint16_t server_picoseconds{0};
    DateTime source_timestamp;
    DateTime server_timestamp;

    DataValue() = default;
    DataValue(Variant v) : value{std::move(v)} {}
    DataValue(StatusCode code) : status{code} {}
    DataValue(Variant v, StatusCode code, DateTime source = {})
        : value{std::move(v)}, status{code}, source_timestamp{source}
    {
    }

    friend bool operator==(const DataValue&, const DataValue&) = default;
};

} // namespace busbar
