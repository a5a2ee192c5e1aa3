#include <limits>

#include "subscribed.hpp"

namespace busbar::tool::rules {

namespace {
namespace subscriptions {

constexpr std::uint32_t no_such_id = 0xFFFF'FFF0U;

Result<DeleteSubscriptionsResponse> remove(Line& line, Array<std::uint32_t> ids)
{
    DeleteSubscriptionsRequest request;
    request.subscription_ids = std::move(ids);
    return line.ask<DeleteSubscriptionsResponse>(std::move(request));
}

/// Judges the revised parameters; the Subscription is deleted.
template <typename Judge>
Answer revised(Subject& subject, const CreateSubscriptionRequest& request, Judge judge)
{
    return with(subject.ask<CreateSubscriptionResponse>(request),
                [&](const CreateSubscriptionResponse& response) {
                    static_cast<void>(remove(subject.session(), {response.subscription_id}));
                    return judge(response);
                });
}

CreateSubscriptionRequest requested(double interval, std::uint32_t keep_alive,
                                    std::uint32_t lifetime)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = interval;
    request.requested_max_keep_alive_count = keep_alive;
    request.requested_lifetime_count = lifetime;
    request.publishing_enabled = true;
    return request;
}

/// The interval that a server makes of one that it cannot have.
Answer interval(Subject& subject, double asked)
{
    return revised(subject, requested(asked, 10, 100),
                   [](const CreateSubscriptionResponse& response) {
                       return expect(response.revised_publishing_interval > 0,
                                     std::to_string(response.revised_publishing_interval));
                   });
}

Answer lifetime(const CreateSubscriptionResponse& response)
{
    return expect(response.revised_lifetime_count / 3 >= response.revised_max_keep_alive_count,
                  "lifetime " + std::to_string(response.revised_lifetime_count) + ", keep-alive " +
                      std::to_string(response.revised_max_keep_alive_count));
}

Result<ModifySubscriptionResponse> modify(Line& line, std::uint32_t id)
{
    ModifySubscriptionRequest request;
    request.subscription_id = id;
    request.requested_publishing_interval = 100;
    request.requested_max_keep_alive_count = 5;
    request.requested_lifetime_count = 100;
    return line.ask<ModifySubscriptionResponse>(request);
}

Answer modified(Subject& subject)
{
    Subscribed subscription{subject};
    return with(modify(subject.session(), subscription.id()),
                [](const ModifySubscriptionResponse& response) {
                    return expect(response.revised_publishing_interval > 0 &&
                                      response.revised_lifetime_count / 3 >=
                                          response.revised_max_keep_alive_count,
                                  "an interval of 0, or too short a lifetime");
                });
}

Answer of_other_session(Subject& subject)
{
    Subscribed subscription{subject};
    Line other = subject.other_session();
    Answer answer = service_result(modify(other, subscription.id()));
    other.close();
    return answer;
}

Result<SetPublishingModeResponse> enable(Subject& subject, Array<std::uint32_t> ids, bool enabled)
{
    SetPublishingModeRequest request;
    request.publishing_enabled = enabled;
    request.subscription_ids = std::move(ids);
    return subject.ask<SetPublishingModeResponse>(std::move(request));
}

Answer disabled(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(enable(subject, {subscription.id()}, false));
    static_cast<void>(subscription.add(item_of(some_scalar())));
    const PublishResponse message =
        subscription.publish_until([](const PublishResponse&) { return true; });
    return expect(is_keep_alive(message), "a notification");
}

Answer removed_twice(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(remove(subject.session(), {subscription.id()}));
    Answer answer = operation_result(remove(subject.session(), {subscription.id()}));
    subscription.forget();
    return answer;
}

Answer removed_in_part(Subject& subject)
{
    Subscribed subscription{subject};
    const auto response = remove(subject.session(), {subscription.id(), no_such_id});
    if (!response) {
        return came(response.error());
    }
    subscription.forget();
    return expect(response->results.size() == 2 && response->results[0].is_good() &&
                      response->results[1] == status::Bad_SubscriptionIdInvalid,
                  "other results");
}

Answer without_subscription(Subject& subject)
{
    Line line = subject.other_session();
    Answer answer = service_result(line.ask<PublishResponse>(PublishRequest{}));
    line.close();
    return answer;
}

Answer deleted_while_waiting(Subject& subject)
{
    Line line = subject.other_session();
    const auto created = line.ask<CreateSubscriptionResponse>(requested(60'000, 100, 1'000));
    if (!created) {
        throw Refused{created.error(), "CreateSubscription"};
    }
    // The first one takes the message that the first interval ends with, if that is short.
    const std::uint32_t first = line.send(PublishRequest{});
    static_cast<void>(remove(line, {created->subscription_id}));
    Answer answer = service_result(line.wait_for<PublishResponse>(first));
    line.close();
    return answer;
}

Answer first_message(Subject& subject)
{
    Subscribed subscription{subject};
    const auto message = subscription.publish();
    return with(message, [](const PublishResponse& each) {
        return expect(is_keep_alive(each) && each.notification_message.sequence_number == 1,
                      "sequenceNumber " +
                          std::to_string(each.notification_message.sequence_number) +
                          (is_keep_alive(each) ? "" : ", with notifications"));
    });
}

Answer numbers(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(subscription.add(item_of(some_scalar())));
    const std::uint32_t first = subscription.next_data().notification_message.sequence_number;
    const std::uint32_t second = subscription.next_data().notification_message.sequence_number;
    return expect(first == 1 && second == 2,
                  std::to_string(first) + " and " + std::to_string(second));
}

Answer keep_alive_number(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(subscription.add(item_of(some_array())));
    const std::uint32_t data = subscription.next_data().notification_message.sequence_number;
    const std::uint32_t idle =
        subscription.publish_until(is_keep_alive).notification_message.sequence_number;
    return expect(idle == data + 1, std::to_string(idle) + " after " + std::to_string(data));
}

Answer own_id(Subject& subject)
{
    Subscribed subscription{subject};
    return with(subscription.publish(), [&](const PublishResponse& message) {
        return expect(message.subscription_id == subscription.id(),
                      std::to_string(message.subscription_id));
    });
}

Answer publish_time(Subject& subject)
{
    Subscribed subscription{subject};
    return with(subscription.publish(), [](const PublishResponse& message) {
        return expect(message.notification_message.publish_time != DateTime{}, "no time");
    });
}

/// A message with values that was not acknowledged, and a Subscription.
struct Sent {
    explicit Sent(Subject& subject) : subscription{subject}
    {
        static_cast<void>(subscription.add(item_of(some_array())));
        message = subscription.next_data();
    }
    [[nodiscard]] std::uint32_t number() const
    {
        return message.notification_message.sequence_number;
    }
    [[nodiscard]] bool is_kept() const
    {
        const auto& numbers = message.available_sequence_numbers;
        return std::find(numbers.begin(), numbers.end(), number()) != numbers.end();
    }
    /// The result of acknowledging this message of this Subscription.
    [[nodiscard]] Answer acknowledged(std::uint32_t id, std::uint32_t sequence_number)
    {
        return operation_result(subscription.publish({{id, sequence_number}}));
    }
    [[nodiscard]] Answer acknowledged() { return acknowledged(subscription.id(), number()); }

    Subscribed subscription;
    PublishResponse message;
};

Answer available(Subject& subject)
{
    const Sent sent{subject};
    return expect(sent.is_kept(), std::to_string(sent.message.available_sequence_numbers.size()) +
                                      " numbers without this one");
}

Answer not_available(Subject& subject)
{
    Sent sent{subject};
    const auto next = sent.subscription.publish({{sent.subscription.id(), sent.number()}});
    return with(next, [&](const PublishResponse& message) {
        const auto& numbers = message.available_sequence_numbers;
        return expect(std::find(numbers.begin(), numbers.end(), sent.number()) == numbers.end(),
                      "the number is still there");
    });
}

Answer limited(Subject& subject)
{
    Subscribed subscription{subject, 1};
    static_cast<void>(subscription.create({item_of(some_array(), 1), item_of(some_array(), 2)}));
    const PublishResponse first = subscription.next_data();
    const std::size_t size = values_of(first).size();
    return expect(size == 1 && first.more_notifications,
                  std::to_string(size) + " values, moreNotifications = " +
                      (first.more_notifications ? "true" : "false"));
}

Result<RepublishResponse> republish(Subject& subject, std::uint32_t id, std::uint32_t number)
{
    RepublishRequest request;
    request.subscription_id = id;
    request.retransmit_sequence_number = number;
    return subject.ask<RepublishResponse>(request);
}

Answer same_message(Subject& subject)
{
    const Sent sent{subject};
    if (!sent.is_kept()) {
        return not_applicable("the server keeps no messages");
    }
    return with(republish(subject, sent.subscription.id(), sent.number()),
                [&](const RepublishResponse& response) {
                    return expect(response.notification_message ==
                                      sent.message.notification_message,
                                  "another message");
                });
}

Answer acknowledged_message(Subject& subject)
{
    Sent sent{subject};
    static_cast<void>(sent.acknowledged());
    return service_result(republish(subject, sent.subscription.id(), sent.number()));
}

Result<TransferSubscriptionsResponse> transfer(Line& line, Array<std::uint32_t> ids)
{
    TransferSubscriptionsRequest request;
    request.subscription_ids = std::move(ids);
    return line.ask<TransferSubscriptionsResponse>(std::move(request));
}

/// True if nothing proves to the server that two sessions are the same client's (Part 4, 5.14.7.1).
bool is_unproven(const Subject& subject)
{
    return std::holds_alternative<client::AnonymousUser>(subject.config().identity) &&
           subject.endpoint().security_mode == MessageSecurityMode::None;
}

Answer no_transfer()
{
    return not_applicable("an anonymous user without security may not take Subscriptions over");
}

Answer transferred(Subject& subject)
{
    if (is_unproven(subject)) {
        return no_transfer();
    }
    Subscribed subscription{subject};
    Line other = subject.other_session();
    Answer answer = operation_result(transfer(other, {subscription.id()}));
    static_cast<void>(remove(other, {subscription.id()}));
    subscription.forget();
    other.close();
    return answer;
}

Answer told_of_transfer(Subject& subject)
{
    if (is_unproven(subject)) {
        return no_transfer();
    }
    Subscribed subscription{subject};
    static_cast<void>(subscription.publish());
    const std::uint32_t waiting = subscription.send_publish();
    Line other = subject.other_session();
    const auto response = transfer(other, {subscription.id()});
    if (!response || response->results.size() != 1 || response->results[0].status_code.is_bad()) {
        return not_applicable("the Subscription is not transferred");
    }
    const auto message = subject.session().wait_for<PublishResponse>(waiting);
    static_cast<void>(remove(other, {subscription.id()}));
    subscription.forget();
    other.close();
    if (!message) {
        return came(message.error());
    }
    for (const ExtensionObject& each : message->notification_message.notification_data) {
        if (const auto* const change = each.get_if<StatusChangeNotification>()) {
            return came(change->status);
        }
    }
    return wrong("no StatusChangeNotification");
}

constexpr Wanted nothing{status::Bad_NothingToDo};
constexpr Wanted no_subscription{status::Bad_SubscriptionIdInvalid};
constexpr const char* creating = "Part 4, 5.14.2.2";
constexpr const char* publish_status = "Part 4, 5.14.5.4";

const SpecRule rules[] = {
    {"subscription-interval-zero", "CreateSubscription", "An interval of 0 is revised",
     "requestedPublishingInterval = 0", "a revisedPublishingInterval above 0", creating,
     [](Subject& subject) { return interval(subject, 0); }},
    {"subscription-interval-negative", "CreateSubscription", "A negative interval is revised",
     "requestedPublishingInterval = -1000", "a revisedPublishingInterval above 0", creating,
     [](Subject& subject) { return interval(subject, -1'000); }},
    {"subscription-interval-nan", "CreateSubscription",
     "An interval that is not a number is revised", "requestedPublishingInterval = NaN",
     "a revisedPublishingInterval above 0", "Part 4, 5.14.2.1",
     [](Subject& subject) { return interval(subject, std::numeric_limits<double>::quiet_NaN()); }},
    {"subscription-lifetime", "CreateSubscription",
     "The lifetime is three keep-alive counts or more",
     "requestedLifetimeCount = 1, requestedMaxKeepAliveCount = 10",
     "revisedLifetimeCount >= 3 * revisedMaxKeepAliveCount", creating,
     [](Subject& subject) { return revised(subject, requested(1'000, 10, 1), lifetime); }},
    {"subscription-counts-large", "CreateSubscription", "Counts that are too large are revised",
     "both counts = 4294967295", "revisedLifetimeCount >= 3 * revisedMaxKeepAliveCount", creating,
     [](Subject& subject) {
         return revised(subject, requested(1'000, 0xFFFF'FFFFU, 0xFFFF'FFFFU), lifetime);
     }},
    {"subscription-keep-alive-zero", "CreateSubscription", "A keep-alive count of 0 is revised",
     "requestedMaxKeepAliveCount = 0", "a revisedMaxKeepAliveCount above 0", creating,
     [](Subject& subject) {
         return revised(subject, requested(1'000, 0, 0),
                        [](const CreateSubscriptionResponse& response) {
                            return expect(response.revised_max_keep_alive_count > 0, "0");
                        });
     }},
    {"subscription-id", "CreateSubscription", "A Subscription has an id", "any",
     "a subscriptionId above 0", "Part 4, 7.19",
     [](Subject& subject) {
         return revised(subject, requested(1'000, 10, 100),
                        [](const CreateSubscriptionResponse& response) {
                            return expect(response.subscription_id > 0, "0");
                        });
     }},
    {"subscription-modify", "ModifySubscription", "A Subscription is modified",
     "requestedPublishingInterval = 100", "revised parameters", "Part 4, 5.14.3.2", modified},
    {"subscription-modify-unknown", "ModifySubscription",
     "A Subscription that is not there is refused", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.14.3.3",
     [](Subject& subject) { return service_result(modify(subject.session(), no_such_id)); }},
    {"subscription-other-session", "ModifySubscription", "A Subscription belongs to its session",
     "a Subscription of another session", no_subscription, "Part 4, 5.14.1.1", of_other_session},
    {"subscription-mode-nothing", "SetPublishingMode", "No Subscriptions are refused",
     "subscriptionIds = []", nothing, "Part 4, 5.14.4.3",
     [](Subject& subject) { return service_result(enable(subject, {}, true)); }},
    {"subscription-mode-unknown", "SetPublishingMode",
     "A Subscription that is not there is invalid", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.14.4.4",
     [](Subject& subject) { return operation_result(enable(subject, {no_such_id}, true)); }},
    {"subscription-disabled", "SetPublishingMode",
     "Without publishing only keep-alive messages are sent", "publishingEnabled = false",
     "a keep-alive message", "Part 4, 5.14.1.1", disabled},
    {"subscription-delete-nothing", "DeleteSubscriptions", "No Subscriptions are refused",
     "subscriptionIds = []", nothing, "Part 4, 5.14.8.3",
     [](Subject& subject) { return service_result(remove(subject.session(), {})); }},
    {"subscription-delete-unknown", "DeleteSubscriptions",
     "A Subscription that is not there is invalid", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.14.8.4",
     [](Subject& subject) { return operation_result(remove(subject.session(), {no_such_id})); }},
    {"subscription-delete-twice", "DeleteSubscriptions", "A deleted Subscription is not there",
     "the same Subscription twice", no_subscription, "Part 4, 5.14.8.4", removed_twice},
    {"subscription-delete-part", "DeleteSubscriptions", "Each Subscription has its result",
     "a Subscription and one that is not there", "Good and Bad_SubscriptionIdInvalid",
     "Part 4, 5.14.8.2", removed_in_part},
    {"publish-no-subscription", "Publish", "Without a Subscription there is nothing to publish",
     "a Publish in a session without Subscriptions", status::Bad_NoSubscription, "Part 4, 5.14.5.3",
     without_subscription},
    {"publish-deleted", "Publish", "The last Subscription ends what waits for it",
     "a Publish that waits when the Subscription is deleted", status::Bad_NoSubscription,
     "Part 4, 5.14.8.1", deleted_while_waiting},
    {"publish-first", "Publish", "The first message comes after the first interval",
     "a Publish for a Subscription without items", "a keep-alive message with sequenceNumber 1",
     "Part 4, 5.14.1.1", first_message},
    {"publish-numbers", "Publish", "Messages are numbered from 1",
     "two messages of an item of CurrentTime", "sequenceNumber 1, then 2", "Part 4, 7.26", numbers},
    {"publish-keep-alive-number", "Publish", "A keep-alive message has the next number",
     "a keep-alive message after one with a value", "the next sequenceNumber", "Part 4, 5.14.1.1",
     keep_alive_number},
    {"publish-id", "Publish", "A message names its Subscription", "a Publish",
     "the id of the Subscription", "Part 4, 5.14.5.2", own_id},
    {"publish-time", "Publish", "A message has the time when it was sent", "a Publish",
     "a publishTime", "Part 4, 7.26", publish_time},
    {"publish-available", "Publish", "A message is kept until it is acknowledged",
     "a message with values", "its number in availableSequenceNumbers", "Part 4, 5.14.5.2",
     available},
    {"publish-acknowledged", "Publish", "A message is acknowledged", "its sequenceNumber",
     one_of(status::Good, status::Good_RetransmissionQueueNotSupported), publish_status,
     [](Subject& subject) { return Sent{subject}.acknowledged(); }},
    {"publish-acknowledged-gone", "Publish", "An acknowledged message is no longer kept",
     "its sequenceNumber", "availableSequenceNumbers without it", "Part 4, 5.14.5.2",
     not_available},
    {"publish-acknowledged-twice", "Publish", "A message is acknowledged once",
     "its sequenceNumber twice",
     one_of(status::Bad_SequenceNumberUnknown, status::Good_RetransmissionQueueNotSupported),
     publish_status,
     [](Subject& subject) {
         Sent sent{subject};
         static_cast<void>(sent.acknowledged());
         return sent.acknowledged();
     }},
    {"publish-acknowledged-unknown", "Publish", "A message that was not sent is unknown",
     "sequenceNumber = 4294967280",
     one_of(status::Bad_SequenceNumberUnknown, status::Good_RetransmissionQueueNotSupported),
     publish_status,
     [](Subject& subject) {
         Sent sent{subject};
         return sent.acknowledged(sent.subscription.id(), no_such_id);
     }},
    {"publish-acknowledged-subscription", "Publish",
     "A Subscription that is not there acknowledges nothing", "subscriptionId = 4294967280",
     no_subscription, publish_status,
     [](Subject& subject) { return Sent{subject}.acknowledged(no_such_id, 1); }},
    {"publish-limit", "Publish", "maxNotificationsPerPublish is kept",
     "maxNotificationsPerPublish = 1, two values", "one value and moreNotifications", creating,
     limited},
    {"republish", "Republish", "A message that is kept is sent again", "its sequenceNumber",
     "the same message", "Part 4, 5.14.6.1", same_message},
    {"republish-acknowledged", "Republish", "An acknowledged message is gone",
     "the sequenceNumber of an acknowledged message", status::Bad_MessageNotAvailable,
     "Part 4, 5.14.6.3", acknowledged_message},
    {"republish-unknown", "Republish", "A message that was not sent is not available",
     "retransmitSequenceNumber = 4294967280", status::Bad_MessageNotAvailable, "Part 4, 5.14.6.3",
     [](Subject& subject) {
         const Subscribed subscription{subject};
         return service_result(republish(subject, subscription.id(), no_such_id));
     }},
    {"republish-subscription-unknown", "Republish", "A Subscription that is not there is refused",
     "subscriptionId = 4294967280", no_subscription, "Part 4, 5.14.6.3",
     [](Subject& subject) { return service_result(republish(subject, no_such_id, 1)); }},
    {"transfer-nothing", "TransferSubscriptions", "No Subscriptions are refused",
     "subscriptionIds = []", nothing, "Part 4, 5.14.7.3",
     [](Subject& subject) { return service_result(transfer(subject.session(), {})); }},
    {"transfer-unknown", "TransferSubscriptions", "A Subscription that is not there is invalid",
     "subscriptionId = 4294967280", no_subscription, "Part 4, 5.14.7.4",
     [](Subject& subject) { return operation_result(transfer(subject.session(), {no_such_id})); }},
    {"transfer", "TransferSubscriptions", "Another session of the user takes over",
     "a Subscription of another session", status::Good, "Part 4, 5.14.7.1", transferred},
    {"transfer-told", "TransferSubscriptions", "The session that had the Subscription is told",
     "a Publish that waits there", status::Good_SubscriptionTransferred, "Part 4, 5.14.7.1",
     told_of_transfer},
};

} // namespace subscriptions
} // namespace

std::span<const SpecRule> subscription_rules()
{
    return subscriptions::rules;
}

} // namespace busbar::tool::rules
