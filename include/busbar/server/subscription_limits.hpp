#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>

namespace busbar::server {

/// Derives the revised sampling interval from the requested one (Part 4, 7.21).
struct BUSBAR_API SamplingPolicy {
    /// The range of intervals. 0 requests the shortest; a negative value or NaN requests the
    /// Subscription's publishing interval.
    std::chrono::milliseconds min_interval{10};
    std::chrono::milliseconds max_interval{3'600'000};
    /// If not empty, only these intervals exist, in ascending order; the nearest one is taken, or
    /// the shorter of two that are equally near.
    std::vector<std::chrono::milliseconds> intervals;
    /// An item that requests 0 and whose source is a process image is sampled at each scan; its
    /// revised interval is then 0, as for sources that report by exception.
    bool samples_each_scan{true};
    /// If set, a Good value that was sampled this many percent later than the revised interval gets
    /// Good_Overload.
    std::optional<double> overload_percent;

    /// Returns the revised interval; zero only if `can_follow_scans` and the scans are to be
    /// followed. Otherwise it is never shorter than the Variable's MinimumSamplingInterval, of
    /// which 0 (continuous) and -1 (indeterminate) set no limit (Part 3, 5.6.2; Part 4, 5.13.1.2).
    [[nodiscard]] Duration revise(double requested_milliseconds, Duration publishing_interval,
                                  bool can_follow_scans,
                                  double minimum_sampling_interval = 0) const;
};

/// 200 to 900 ms by 100, 1 to 9 s by one second, 10 to 60 s by ten, with Good_Overload past 5 %.
[[nodiscard]] BUSBAR_API SamplingPolicy stepped_sampling();

/// Limits of the resources of Subscriptions and MonitoredItems. All are finite.
struct SubscriptionLimits {
    // Beyond these CreateSubscription and TransferSubscriptions answer Bad_TooManySubscriptions,
    // unless a Subscription whose client has gone gives way: the one that has been without a
    // session for longest, then without a channel, of the user who has most; a user never displaces
    // one who has less.

    std::size_t max_subscriptions_per_session{100};
    /// Subscriptions of all sessions of a user, and those that ended sessions left. Anonymous users
    /// of an IPv4 address or of the /64 of an IPv6 address count as one.
    std::size_t max_subscriptions_per_user{500};
    std::size_t max_subscriptions{1'000};

    // Beyond these an item answers Bad_TooManyMonitoredItems, unless a Subscription gives way as
    // above.

    std::size_t max_items_per_subscription{100'000};
    std::size_t max_items_per_user{500'000};
    std::size_t max_items{1'000'000};
    /// Links of one item that triggers others, and of one that is triggered (Part 4, 5.13.1.6):
    /// SetTriggering answers Bad_TooManyOperations for one more.
    std::size_t max_triggering_links{256};

    // The ranges of revised values (Part 4, 5.14.2.2 and 7.21).

    std::chrono::milliseconds min_publishing_interval{10};
    std::chrono::milliseconds max_publishing_interval{3'600'000};
    /// Range of the time without a message after which a keep-alive is sent.
    std::chrono::milliseconds min_keep_alive{0};
    std::chrono::milliseconds max_keep_alive{3'600'000};
    /// Range of the time that a Subscription lives without its client. At least three keep-alives.
    std::chrono::milliseconds min_lifetime{0};
    std::chrono::milliseconds max_lifetime{3 * 3'600'000};
    std::uint32_t max_notifications_per_publish{100'000};
    std::uint32_t max_queue_size{10'000};
    std::uint32_t max_event_queue_size{10'000};
    SamplingPolicy sampling;

    // Publishing.

    /// Beyond it the oldest Publish request of the session answers Bad_TooManyPublishRequests.
    std::size_t max_publish_requests{20};
    std::size_t max_acknowledgements{10'000};
    /// Messages that one Subscription keeps for Republish. Part 4, 5.14.1.1 requires at least twice
    /// as many as there may be Publish requests.
    std::size_t max_retransmission_messages{100};
    /// Bytes of one NotificationMessage; further Notifications go into the next one.
    std::size_t max_message_size{4U << 20U};
    /// StatusChangeNotifications that wait for a Publish request of their session.
    std::size_t max_status_changes{100};

    // Memory, in bytes, for items, queued values and messages kept for Republish.

    std::size_t max_subscription_memory{256U << 20U};
    std::size_t max_memory{std::size_t{1} << 30U};
};

/// The limits of an RD81OPC96: 10 Subscriptions in a session and 150 in all, 15,000 items, queues
/// of 10, stepped sampling.
[[nodiscard]] BUSBAR_API SubscriptionLimits rd81opc96_subscriptions();
/// The limits of NJ501 and NX102 controllers: 100 Subscriptions and 2,000 items.
[[nodiscard]] BUSBAR_API SubscriptionLimits nj501_subscriptions();
[[nodiscard]] BUSBAR_API SubscriptionLimits nx102_subscriptions();

} // namespace busbar::server
