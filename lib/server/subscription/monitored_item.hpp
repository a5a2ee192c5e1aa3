#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/types/monitored_item.hpp>

namespace busbar::server::detail {

class Subscription;
class SubscriptionTable;

/// The context of creating, changing and sampling an item.
struct ItemContext {
    SubscriptionTable& all;
    Subscription& subscription;
    TimePoint now;
};

/// The result of CreateMonitoredItems and ModifyMonitoredItems for one item (Part 4, 5.13.2 and
/// 5.13.3).
struct ItemRevision {
    StatusCode status;
    double sampling_interval{0};
    std::uint32_t queue_size{0};
    ExtensionObject filter_result;
};

/// A MonitoredItem (Part 4, 5.13.1): queues Notifications until its Subscription takes them.
///
/// It has the common part of data and events: mode, triggering and the place in the Subscription's
/// list of items to report. A derived class has queue and filter, charges its Subscription for its
/// memory, and returns that when it is destroyed. Keeps its address; belongs to its Subscription,
/// which outlives it.
class MonitoredItem {
public:
    enum class Kind : std::uint8_t { Data, Event };

    MonitoredItem(Subscription& subscription, Kind kind, std::uint32_t client_handle,
                  MonitoringMode mode);
    MonitoredItem(const MonitoredItem&) = delete;
    MonitoredItem& operator=(const MonitoredItem&) = delete;
    virtual ~MonitoredItem();

    [[nodiscard]] Subscription& subscription() const { return *subscription_; }
    [[nodiscard]] Kind kind() const { return kind_; }
    /// Unique in its Subscription.
    [[nodiscard]] std::uint32_t id() const { return id_; }
    [[nodiscard]] std::uint32_t client_handle() const { return client_handle_; }
    [[nodiscard]] MonitoringMode mode() const { return static_cast<MonitoringMode>(mode_); }

    // For the Subscription and its services.

    /// Number of waiting Notifications.
    [[nodiscard]] virtual std::size_t queued() const = 0;
    /// Prefetches the oldest Notification.
    virtual void fetch_notification() const {}
    /// Upper bound of the oldest Notification's encoded size.
    [[nodiscard]] virtual std::size_t notification_size() const { return 0; }
    /// Writes the oldest Notification, a MonitoredItemNotification or an EventFieldList, and
    /// removes it. The queue must not be empty. If it takes more than `most` bytes,
    /// Bad_EncodingLimitsExceeded replaces the part that is too large (Part 4, 7.22.3).
    virtual void take_notification(binary::Writer& writer, std::size_t most) = 0;
    /// Takes new parameters (Part 4, 5.13.3); changes nothing if `revision.status` is bad
    /// afterwards.
    virtual void modify(const ItemContext& context, const MonitoringParameters& parameters,
                        TimestampsToReturn timestamps, ItemRevision& revision) = 0;
    /// Deletes all queued Notifications when the new mode is Disabled (Part 4, 5.13.4).
    void set_mode(const ItemContext& context, MonitoringMode mode);
    /// The Subscription belongs to another user from now on: rights must be checked again.
    virtual void user_changed(const ItemContext& context) = 0;
    /// Queues the last value again if the queue is empty (Part 4, 5.14.7.2; Part 5, 9.2).
    virtual void resend(const ItemContext&) {}

    /// Number of Notifications that the Subscription may take now: all if the mode is Reporting,
    /// those that a trigger released if it is Sampling.
    [[nodiscard]] std::size_t reportable() const;

    // Triggering (Part 4, 5.13.1.6): items that report when this one has a Notification.

    /// Adds a link; Good also if it exists. Bad_TooManyOperations past `max_links` of either item,
    /// Bad_OutOfMemory if the Subscription cannot pay for it.
    [[nodiscard]] StatusCode add_link(MonitoredItem& triggered, std::size_t max_links);
    /// Returns false if there is no such link.
    [[nodiscard]] bool remove_link(MonitoredItem& triggered);

protected:
    /// Called after each Notification that was queued, also one that replaced another: triggers
    /// linked items and notifies the Subscription.
    void notify();
    void set_client_handle(std::uint32_t client_handle) { client_handle_ = client_handle; }
    /// Empties the queue.
    virtual void clear() = 0;
    /// Starts or stops sampling, or receiving events; mode() is already the new one. If it throws
    /// it must have changed nothing.
    virtual void mode_changed(const ItemContext&, MonitoringMode /*before*/) {}

private:
    friend class ItemList;
    friend class ReadyList;

    void forget_link(MonitoredItem& triggered);
    [[nodiscard]] bool triggers(const MonitoredItem& triggered) const;
    /// Allows the present queue to be reported.
    void release_queue();
    void keep_mode(MonitoringMode mode) { mode_ = static_cast<std::uint8_t>(mode); }

    Subscription* subscription_;
    /// Neighbours in the ready list, which it is part of if is_ready_.
    MonitoredItem* previous_{nullptr};
    MonitoredItem* next_{nullptr};
    /// Items that this one triggers, and those that trigger it; both sides know each other. Null if
    /// there never were any.
    struct Links {
        std::vector<MonitoredItem*> triggered;
        std::vector<MonitoredItem*> triggers;
    };
    std::unique_ptr<Links> links_;
    std::uint32_t id_{0};
    std::uint32_t client_handle_;
    /// Number of the queue's oldest Notifications that a trigger has released.
    std::uint32_t released_{0};
    /// A MonitoringMode.
    std::uint8_t mode_;
    Kind kind_;
    bool is_ready_{false};
};

/// Creates items of events, which this folder does not know.
class EventItems {
public:
    EventItems() = default;
    EventItems(const EventItems&) = delete;
    EventItems& operator=(const EventItems&) = delete;

    /// Creates an item of a Node's EventNotifier; null, with the reason in `revision.status`, if
    /// that is impossible. Attribute and mode are already checked.
    [[nodiscard]] virtual std::unique_ptr<MonitoredItem>
    make(const ItemContext& context, const MonitoredItemCreateRequest& request,
         ItemRevision& revision) = 0;

protected:
    ~EventItems() = default;
};

} // namespace busbar::server::detail
