#pragma once

#include <limits>

#include "heard.hpp"
#include "puppet_requester.hpp"

namespace busbar::test {

/// Subscriptions at a server that does what the test says. The Subscription's id there is 7.
struct PuppetFixture {
    static constexpr std::uint32_t server_id = 7;

    PuppetFixture() { subscriptions.session_started(Subscriptions::SessionStart::New); }

    void settle()
    {
        for (int i = 0; i < 1'000; ++i) {
            const bool moved = requester.run();
            if (subscriptions.next_deadline() <= requester.time) {
                subscriptions.handle_deadline(requester.time);
            } else if (!moved) {
                return;
            }
        }
        FAIL("there is no end of it");
    }
    void pass(Duration duration)
    {
        requester.time += duration;
        requester.expire();
        settle();
    }
    template <typename Response>
    void reply(const Response& response)
    {
        requester.reply(response);
        settle();
    }
    void refuse(StatusCode status)
    {
        requester.refuse(status);
        settle();
    }

    [[nodiscard]] static CreateSubscriptionResponse created(std::uint32_t id = server_id,
                                                            double interval = 1'000)
    {
        CreateSubscriptionResponse response;
        response.subscription_id = id;
        response.revised_publishing_interval = interval;
        response.revised_max_keep_alive_count = 10;
        response.revised_lifetime_count = 30;
        return response;
    }
    /// Creates the Subscription with items of nodes 1 to `count`, which the server calls 101 on.
    void start(std::uint32_t count = 1)
    {
        subscription = subscriptions.create({}, heard.handlers()).value();
        std::vector<client::ItemSettings> wishes(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            wishes[i].node = NodeId{1, i + 1};
        }
        items = subscriptions.add_items(subscription, wishes).value();
        settle();
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        reply(created());
        make_items();
    }
    void make_items()
    {
        const auto request = requester.take<CreateMonitoredItemsRequest>();
        CreateMonitoredItemsResponse response;
        for (std::uint32_t i = 0; i < request.items_to_create.size(); ++i) {
            response.results.push_back({status::Good, 101 + i, 100, 1, {}});
        }
        reply(response);
    }

    /// The time of the server's message with that number.
    [[nodiscard]] static DateTime time_of(std::uint32_t number) { return {1'000 + number}; }
    [[nodiscard]] NotificationMessage message(std::uint32_t number) const
    {
        DataChangeNotification data;
        data.monitored_items.push_back({items[0], DataValue{static_cast<std::int32_t>(number)}});
        NotificationMessage message{number, time_of(number), {}};
        message.notification_data.push_back(ExtensionObject::from(data));
        return message;
    }
    /// Answers the oldest Publish request.
    PublishRequest publish(NotificationMessage content, std::uint32_t id = server_id)
    {
        const auto request = requester.take<PublishRequest>();
        PublishResponse response;
        response.subscription_id = id;
        response.notification_message = std::move(content);
        response.results.resize(request.subscription_acknowledgements.size());
        reply(response);
        return request;
    }
    void publish_keep_alive(std::uint32_t next) { publish({next, time_of(next), {}}); }
    void publish_status(std::uint32_t number, StatusCode status)
    {
        NotificationMessage content{number, time_of(number), {}};
        content.notification_data.push_back(
            ExtensionObject::from(StatusChangeNotification{status, {}}));
        publish(std::move(content));
    }
    void republish(std::uint32_t number)
    {
        CHECK(requester.take<RepublishRequest>().retransmit_sequence_number == number);
        RepublishResponse response;
        response.notification_message = message(number);
        reply(response);
    }
    /// As often as a client is patient.
    void leave_republish_unanswered()
    {
        for (int i = 0; i < 3; ++i) {
            CHECK(requester.count<PublishRequest>() == 0);
            static_cast<void>(requester.take<RepublishRequest>());
            refuse(status::Bad_Timeout);
            pass(std::chrono::seconds{1});
        }
        CHECK(requester.count<PublishRequest>() == 0);
    }
    void refuse_republish(std::uint32_t number)
    {
        CHECK(requester.take<RepublishRequest>().retransmit_sequence_number == number);
        refuse(status::Bad_MessageNotAvailable);
    }

    PuppetRequester requester;
    Subscriptions subscriptions{requester};
    Heard heard;
    SubscriptionHandle subscription{0};
    std::vector<ItemHandle> items;
};

} // namespace busbar::test
