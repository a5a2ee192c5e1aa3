#pragma once

#include "heard.hpp"
#include "reconnecting_requester.hpp"
#include "server/subscription_fixture.hpp"

namespace busbar::test {

/// Subscriptions at a real server, in virtual time.
struct SubscriberFixture : SubscriptionFixture {
    explicit SubscriberFixture(const server::SubscriptionLimits& limits = server_limits())
        : SubscriptionFixture{limits}
    {
        requester.open_new();
        subscriptions.session_started(Subscriptions::SessionStart::New);
    }
    [[nodiscard]] static server::SubscriptionLimits server_limits()
    {
        server::SubscriptionLimits limits;
        limits.max_publish_requests = 5;
        limits.max_retransmission_messages = 50;
        return limits;
    }

    /// Everything that can be done at once.
    void settle()
    {
        requester.time = now;
        for (bool moved = true; moved;) {
            requester.receive();
            moved = requester.run();
            if (subscriptions.next_deadline() <= now) {
                subscriptions.handle_deadline(now);
                moved = true;
            }
        }
    }
    void pass(Duration duration, Duration step = std::chrono::milliseconds{10})
    {
        for (; duration > Duration{0}; duration -= step) {
            advance(step);
            requester.time = now;
            requester.expire();
            settle();
        }
    }
    void cut()
    {
        requester.cut();
        subscriptions.session_lost();
    }
    void start_again(Subscriptions::SessionStart how)
    {
        if (how == Subscriptions::SessionStart::New) {
            requester.open_new();
        } else {
            REQUIRE(requester.resume() == status::Good);
        }
        subscriptions.session_started(how);
        settle();
    }

    [[nodiscard]] static client::SubscriptionSettings fast()
    {
        client::SubscriptionSettings settings;
        settings.publishing_interval = std::chrono::milliseconds{100};
        settings.max_keep_alive_count = 3;
        settings.lifetime_count = 100;
        return settings;
    }
    [[nodiscard]] static client::ItemSettings item(const NodeId& node, std::uint32_t queue = 1)
    {
        client::ItemSettings settings;
        settings.node = node;
        settings.sampling_interval = std::chrono::milliseconds{50};
        settings.queue_size = queue;
        return settings;
    }
    ItemHandle add(SubscriptionHandle subscription, client::ItemSettings settings)
    {
        return subscriptions.add_items(subscription, {std::move(settings)}).value().at(0);
    }

    ReconnectingRequester requester{*this};
    Subscriptions subscriptions{requester};
    Heard heard;
};

} // namespace busbar::test
