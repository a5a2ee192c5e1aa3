#pragma once

#include <functional>
#include <vector>

#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "requests.hpp"

namespace busbar::tool::rules {

/// Returns a request for an item that samples the node's Value as fast as the server does, and
/// reports.
[[nodiscard]] MonitoredItemCreateRequest item_of(NodeId node, std::uint32_t client_handle = 1);

/// A Subscription in the common session, for one rule, with a publishing interval of 50 ms and
/// keep-alive messages after 3 intervals. Deleted with this object.
class Subscribed {
public:
    /// Throws Refused or NoAnswer.
    explicit Subscribed(Subject& subject, std::uint32_t max_notifications = 0);
    Subscribed(const Subscribed&) = delete;
    Subscribed& operator=(const Subscribed&) = delete;
    ~Subscribed();

    [[nodiscard]] std::uint32_t id() const { return id_; }
    /// Keeps the destructor from deleting the Subscription, which is deleted or another session's.
    void forget() { id_ = 0; }

    [[nodiscard]] Result<CreateMonitoredItemsResponse>
    create(std::vector<MonitoredItemCreateRequest> items,
           TimestampsToReturn timestamps = TimestampsToReturn::Both);
    /// Creates one item and returns its id; throws Refused.
    [[nodiscard]] std::uint32_t add(MonitoredItemCreateRequest item);
    [[nodiscard]] std::uint32_t send_publish(std::vector<SubscriptionAcknowledgement> done = {});
    [[nodiscard]] Result<PublishResponse>
    publish(std::vector<SubscriptionAcknowledgement> done = {});
    /// Publishes until a message is what `is_wanted` says; throws Refused, and NoAnswer when the
    /// time of the rule is over.
    [[nodiscard]] PublishResponse
    publish_until(const std::function<bool(const PublishResponse&)>& is_wanted);
    /// Publishes until a message has values.
    [[nodiscard]] PublishResponse next_data();
    /// Lets time pass in which the server samples, and its messages arrive.
    void wait(Duration time);

private:
    Subject* subject_;
    std::uint32_t id_{0};
};

/// The values in a message; none in a keep-alive message.
[[nodiscard]] std::vector<MonitoredItemNotification> values_of(const PublishResponse& message);
[[nodiscard]] bool is_keep_alive(const PublishResponse& message);

} // namespace busbar::tool::rules
