#include "subscribed.hpp"

namespace busbar::tool::rules {

MonitoredItemCreateRequest item_of(NodeId node, std::uint32_t client_handle)
{
    MonitoredItemCreateRequest item;
    item.item_to_monitor = client::attribute_of(std::move(node));
    item.monitoring_mode = MonitoringMode::Reporting;
    item.requested_parameters.client_handle = client_handle;
    item.requested_parameters.queue_size = 10;
    item.requested_parameters.discard_oldest = true;
    return item;
}

Subscribed::Subscribed(Subject& subject, std::uint32_t max_notifications) : subject_{&subject}
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = 50;
    request.requested_max_keep_alive_count = 3;
    request.requested_lifetime_count = 1'000;
    request.max_notifications_per_publish = max_notifications;
    request.publishing_enabled = true;
    const auto response = subject.ask<CreateSubscriptionResponse>(request);
    if (!response) {
        throw Refused{response.error(), "CreateSubscription"};
    }
    id_ = response->subscription_id;
}

Subscribed::~Subscribed()
{
    if (id_ == 0 || !subject_->has_session()) {
        return; // the server ends the Subscription of a lost session by itself
    }
    try {
        DeleteSubscriptionsRequest request;
        request.subscription_ids = {id_};
        subject_->begin(); // if the time of the rule is over, too
        static_cast<void>(subject_->ask<DeleteSubscriptionsResponse>(std::move(request)));
    } catch (const NoAnswer&) {
        // The verdict is there already; the next rule meets a lost session by itself.
    } catch (const Unreachable&) {
        // The next rule meets that by itself, too.
    }
}

Result<CreateMonitoredItemsResponse>
Subscribed::create(std::vector<MonitoredItemCreateRequest> items, TimestampsToReturn timestamps)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = id_;
    request.timestamps_to_return = timestamps;
    request.items_to_create.assign(items.begin(), items.end());
    return subject_->ask<CreateMonitoredItemsResponse>(std::move(request));
}

std::uint32_t Subscribed::add(MonitoredItemCreateRequest item)
{
    const auto response = create({std::move(item)});
    if (!response || response->results.size() != 1 || response->results[0].status_code.is_bad()) {
        throw Refused{response ? status::Bad_UnexpectedError : response.error(),
                      "CreateMonitoredItems"};
    }
    return response->results[0].monitored_item_id;
}

std::uint32_t Subscribed::send_publish(std::vector<SubscriptionAcknowledgement> done)
{
    PublishRequest request;
    request.subscription_acknowledgements.assign(done.begin(), done.end());
    return subject_->session().send(std::move(request));
}

Result<PublishResponse> Subscribed::publish(std::vector<SubscriptionAcknowledgement> done)
{
    return subject_->session().wait_for<PublishResponse>(send_publish(std::move(done)));
}

PublishResponse
Subscribed::publish_until(const std::function<bool(const PublishResponse&)>& is_wanted)
{
    for (;;) {
        auto message = publish();
        if (!message) {
            throw Refused{message.error(), "Publish"};
        }
        if (message->subscription_id == id_ && is_wanted(*message)) {
            return *std::move(message);
        }
    }
}

PublishResponse Subscribed::next_data()
{
    return publish_until(
        [](const PublishResponse& message) { return !values_of(message).empty(); });
}

void Subscribed::wait(Duration time)
{
    // No request has this handle.
    static_cast<void>(subject_->session().has_answer(0, time));
}

std::vector<MonitoredItemNotification> values_of(const PublishResponse& message)
{
    std::vector<MonitoredItemNotification> values;
    for (const ExtensionObject& each : message.notification_message.notification_data) {
        if (const auto* const data = each.get_if<DataChangeNotification>()) {
            values.insert(values.end(), data->monitored_items.begin(), data->monitored_items.end());
        }
    }
    return values;
}

bool is_keep_alive(const PublishResponse& message)
{
    return message.notification_message.notification_data.empty();
}

} // namespace busbar::tool::rules
