#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include <busbar/client/subscriptions.hpp>

namespace busbar::client::detail {

/// The common parameters of items; those that were added together share them.
struct ItemParameters {
    explicit ItemParameters(const ItemSettings& settings);
    [[nodiscard]] bool are_those_of(const ItemSettings& settings) const;
    [[nodiscard]] bool has_events() const;
    /// True if a Read returns what a notification would: neither events nor calculated values.
    [[nodiscard]] bool is_readable() const;
    [[nodiscard]] MonitoringParameters for_server(ItemHandle item) const;

    AttributeId attribute;
    TimestampsToReturn timestamps;
    bool discard_oldest;
    std::uint32_t queue_size;
    double sampling_interval; // ms
    String index_range;
    ExtensionObject filter;
};

/// A MonitoredItem that the user wants.
struct Item {
    NodeAddress node;
    std::shared_ptr<const ItemParameters> parameters;
    SubscriptionHandle subscription{0}; // 0: this place of the table is free
    std::uint32_t server_id{0};
    /// Number of losses of notifications of its Subscription before its last notification.
    std::uint32_t told_after{0};
    std::uint16_t generation{1};
    /// Counts its changes while it is polled, to recognise its obsolete places in a poll.
    std::uint16_t poll_version{0};
    MonitoringMode mode{MonitoringMode::Reporting};
    bool is_created{false};
    bool is_modified{false};
    bool is_mode_changed{false};
};

/// All items, found by their handles in constant time. A handle, which the server gets as
/// ClientHandle, is a place in the table and the number of its earlier uses, so that a late
/// notification is not taken for a new item's.
class ItemTable {
public:
    static constexpr std::size_t capacity = std::size_t{1} << 22U;

    /// Returns 0 if there are `capacity` items.
    [[nodiscard]] ItemHandle add(Item item);
    /// Returns null if there is no such item. Valid until it is removed.
    [[nodiscard]] Item* find(ItemHandle handle);
    void remove(ItemHandle handle);
    [[nodiscard]] std::size_t size() const { return items_.size() - free_.size(); }

private:
    std::deque<Item> items_;
    std::vector<std::uint32_t> free_;
};

} // namespace busbar::client::detail
