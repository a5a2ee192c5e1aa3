#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include <busbar/client/subscriptions.hpp>

namespace busbar::client::detail {

struct ItemParameters;

/// A polled item and its last delivered value.
struct PolledItem {
    ItemHandle handle{0};
    std::uint16_t version{0};
    bool has_value{false};
    NodeId node;
    DataValue last;
};

struct PollKey {
    Duration interval{0};
    TimestampsToReturn timestamps{TimestampsToReturn::Both};

    friend auto operator<=>(const PollKey&, const PollKey&) = default;
};

/// Items that are read together.
struct PollGroup {
    std::vector<PolledItem> items;
    TimePoint due{};
    std::size_t position{0}; // of the next item in the present round
    bool is_reading{false};
};

/// Part 4, 7.22.2: true if a server would report `value` after `last`. A percent deadband, for
/// which the range would have to be known, filters nothing.
[[nodiscard]] bool is_change(const ItemParameters& parameters, const DataValue& last,
                             const DataValue& value);

} // namespace busbar::client::detail
