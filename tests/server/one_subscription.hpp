#pragma once

#include "subscription_fixture.hpp"

namespace busbar::test {

inline CreateSubscriptionRequest one_at_a_time()
{
    auto request = SubscriptionFixture::subscription_request();
    request.max_notifications_per_publish = 1;
    return request;
}

/// One client with one Subscription: a cycle of 100 ms, a keep-alive after 3, an end after 30.
struct OneSubscription : SubscriptionFixture {
    explicit OneSubscription(const CreateSubscriptionRequest& request = subscription_request())
        : level{add_variable("level", 1)}, client{log_in()}, id{subscribe(client, request)}
    {
    }
    void add_item() { CHECK(monitor(client, id, item_request(level)).status_code == status::Good); }
    /// Brings the Subscription from its first message to state KEEPALIVE, one cycle counted.
    void go_to_keep_alive()
    {
        const auto first = publish(client);
        advance(cycle);
        CHECK(take(client, first)); // row 7
        advance(cycle);             // row 9
    }
    [[nodiscard]] bool is_keep_alive(std::uint32_t request)
    {
        const auto response = take(client, request);
        return response && response->notification_message.notification_data.empty();
    }
    [[nodiscard]] std::size_t data_count(std::uint32_t request)
    {
        const auto response = take(client, request);
        return response ? data(response->notification_message).size() : 0;
    }
    [[nodiscard]] bool waits(std::uint32_t request)
    {
        return status_of(client, request) == status::Bad_WouldBlock;
    }

    NodeId level;
    TestClient client;
    std::uint32_t id;
};

} // namespace busbar::test
