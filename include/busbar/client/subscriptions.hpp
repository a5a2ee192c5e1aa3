#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <busbar/client/node_address.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

namespace busbar::client {

/// Handles of this client, valid for the life of the Subscriptions object; the server's ids change
/// when a Subscription has to be created again.
using SubscriptionHandle = std::uint32_t;
/// Identifies a MonitoredItem for as long as its Subscriptions object lives.
using ItemHandle = std::uint32_t;

/// The parameters of CreateSubscription (Part 4, 5.14.2).
struct SubscriptionSettings {
    std::chrono::duration<double, std::milli> publishing_interval{500};
    /// Part 4, 5.14.2; the lifetime count is at least three times the keep-alive count.
    std::uint32_t lifetime_count{60};
    std::uint32_t max_keep_alive_count{10};
    std::uint32_t max_notifications_per_publish{0};
    std::uint8_t priority{0};
    bool is_publishing_enabled{true};
};

/// The parameters of a MonitoredItem (Part 4, 5.13.2).
struct ItemSettings {
    NodeAddress node;
    AttributeId attribute{AttributeId::Value};
    String index_range;
    std::chrono::duration<double, std::milli> sampling_interval{-1};
    std::uint32_t queue_size{1};
    bool discard_oldest{true};
    MonitoringMode mode{MonitoringMode::Reporting};
    TimestampsToReturn timestamps{TimestampsToReturn::Both};
    /// DataChangeFilter or EventFilter, or null. An EventFilter requests events: the attribute is
    /// EventNotifier then.
    ExtensionObject filter;
};

/// The revised settings of an item.
struct ItemStatus {
    StatusCode status;
    double revised_sampling_interval{0};
    std::uint32_t revised_queue_size{0};
    ExtensionObject filter_result;
};

/// A new value of a monitored attribute.
struct DataChange {
    ItemHandle item;
    DataValue value;
    /// Not a notification but the result of a Read after a Gap: the value at that moment,
    /// regardless of filter and sampling interval, or the reason why it cannot be read.
    bool is_read_again{false};
};
/// An event of a monitored notifier.
struct EventArrived {
    ItemHandle item;
    /// The fields that the filter selects, in its order.
    Array<Variant> fields;
};

/// Notifications were lost, or may have been: everything that the server still had is recovered
/// before a Gap is reported. Changes and events within a Gap are never reported.
///
/// Present values are: a data item that reports and has had no notification since gets one soon
/// after the Gap, even if it is the value that was reported last. In a Subscription that was
/// created again all items begin with one. In one that continues the server is asked for them (Part
/// 4, 6.7): by the Method ResendData, which repeats the values of the other items as well, or, if
/// that is not available, by Read (is_read_again). Items that are only sampled for a trigger are
/// not requested, and calculated values, as of an AggregateFilter, are not read: these wait for the
/// next notification.
struct Gap {
    /// The Subscription whose items all have the Gap.
    SubscriptionHandle subscription;
    /// The last moment for which notifications are complete, and the first one after the Gap; the
    /// server's publish time or, without one, the time of its response. Null if there was none.
    DateTime from;
    DateTime to;
    /// Bad_MessageNotAvailable: notifications that the server no longer has.
    /// Bad_SequenceNumberUnknown: its sequence numbers leap. Bad_DecodingError: a part of a message
    /// that is not a notification. Bad_NoSubscription: it was polled. Any other code is the reason
    /// why the Subscription had to be created again: Bad_SubscriptionIdInvalid, Bad_Timeout (its
    /// lifetime), Good_SubscriptionTransferred (to another client), or why a transfer was refused.
    StatusCode reason;
};

/// The present source of a Subscription's values.
enum class DeliveryMode : std::uint8_t {
    None,       // no session, or not created yet
    Publishing, // as Part 4 has it
    Polling,    // the server has no Subscriptions: items are read at their sampling interval
};

/// The handlers of a Subscription. All are called in poll() of the Client, on its thread; spans are
/// valid during the call. Empty functions are skipped; exceptions are logged. They may use
/// Subscriptions freely, and remove what they are called for, but not destroy it.
struct SubscriptionHandlers {
    std::function<void(std::span<const DataChange>)> on_data;
    std::function<void(std::span<const EventArrived>)> on_events;
    /// Created or changed, or the reason of a failure; also if the links of a triggering item were
    /// refused.
    std::function<void(ItemHandle, const ItemStatus&)> on_item;
    std::function<void(const Gap&)> on_gap;
    /// Created or changed, with the revised settings, or the reason of a failure (Bad_ codes).
    std::function<void(StatusCode, DeliveryMode, const CreateSubscriptionResponse&)> on_status;
};

/// Limits of what one client keeps; beyond them Bad_TooManySubscriptions,
/// Bad_TooManyMonitoredItems.
struct SubscriberLimits {
    std::size_t max_subscriptions{100};
    std::size_t max_items{1'000'000};
    /// The maximum number of Publish requests under way (Part 4, 5.14.5): one more than there are
    /// Subscriptions, at least two, at most this.
    std::size_t max_publish_requests{10};
    /// Sequence numbers that wait for their Republish; a message further ahead is a Gap.
    std::size_t max_missing{1'000};
};

/// Keeps the Subscriptions that a user wants, whatever happens to the server: their settings are
/// kept here and restored in every session.
///
/// After a session was resumed, missing notifications are fetched by Republish. After a new session
/// it uses TransferSubscriptions and Republish; if that is refused, the Subscription is created
/// again with its items. If the server has no Subscription service set, items are polled by Read.
/// Anything that could not be recovered is a Gap. Driven by the Client that owns it. Only this
/// object makes the session's Publish requests: an unknown Subscription that answers one is
/// deleted.
class BUSBAR_API Subscriptions {
public:
    explicit Subscriptions(Requester& requester, SubscriberLimits limits = {});
    Subscriptions(const Subscriptions&) = delete;
    Subscriptions& operator=(const Subscriptions&) = delete;
    ~Subscriptions();

    // The user's requests. They never wait: they are carried out when a session allows it, and a
    // handler reports the result.

    /// Creates a Subscription; it is created again on every new session.
    [[nodiscard]] Result<SubscriptionHandle> create(SubscriptionSettings settings,
                                                    SubscriptionHandlers handlers);
    /// Changes the settings (Part 4, 5.14.3).
    Result<void> modify(SubscriptionHandle subscription, SubscriptionSettings settings);
    /// Removes the Subscription and its items.
    Result<void> remove(SubscriptionHandle subscription);
    /// Adds all items or none; the handles are in the order of `items`.
    /// Bad_TimestampsToReturnInvalid, Bad_MonitoringModeInvalid.
    [[nodiscard]] Result<std::vector<ItemHandle>> add_items(SubscriptionHandle subscription,
                                                            std::vector<ItemSettings> items);
    /// Changes everything except the node and the attribute (Part 4, 5.13.3).
    Result<void> modify_items(std::span<const ItemHandle> items, const ItemSettings& settings);
    /// Removes items from their Subscription.
    Result<void> remove_items(std::span<const ItemHandle> items);
    /// Sets the links (Part 4, 5.13.5); kept and repeated like the items. `links` replaces all
    /// previous ones.
    Result<void> set_triggering(ItemHandle trigger, std::vector<ItemHandle> links);

    [[nodiscard]] DeliveryMode mode(SubscriptionHandle subscription) const;
    /// The server's id of the Subscription; 0 while there is none.
    [[nodiscard]] std::uint32_t server_id(SubscriptionHandle subscription) const;

    // The life of the session, reported by the Client.

    /// The way in which a session began.
    enum class SessionStart : std::uint8_t {
        Resumed, // the same session on a new channel
        New,     // another session; Subscriptions of the last one may still live
    };
    /// Continues or creates everything on the new session.
    void session_started(SessionStart how);
    /// Waits for another session.
    void session_lost();

    /// Due at once after a wish or a new session.
    [[nodiscard]] TimePoint next_deadline() const;
    /// `now` is the Requester's now().
    void handle_deadline(TimePoint now);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::client
