#include <chrono>
#include <memory>
#include <utility>

#include <busbar/client/subscriptions.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "client.hpp"

namespace busbar::c {

namespace {

/// Calls the callback, unless an earlier call has ended its Subscription.
void deliver(const Feed& feed, std::uint32_t item, const DataValue& value)
{
    if (feed.has_ended) {
        return;
    }
    Scratch scratch;
    busbar_data_value in_c;
    static_cast<void>(to_c(value, scratch, in_c));
    const InCallback running{*feed.client};
    feed.callback(feed.context, item, &in_c);
}

client::SubscriptionHandlers handlers_of(const std::shared_ptr<Feed>& feed)
{
    client::SubscriptionHandlers handlers;
    handlers.on_data = [feed](std::span<const client::DataChange> changes) {
        for (const client::DataChange& change : changes) {
            deliver(*feed, change.item, change.value);
        }
    };
    handlers.on_item = [feed](client::ItemHandle item, const client::ItemStatus& made) {
        if (made.status.is_bad()) {
            deliver(*feed, item, DataValue{made.status});
        }
    };
    return handlers;
}

/// True for an interval in milliseconds that a service can have (Part 3, 8.13).
bool is_interval(double milliseconds)
{
    return milliseconds >= 0 && milliseconds <= 86'400'000;
}

} // namespace

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_client_subscribe(busbar_client* client, double interval_ms,
                                      busbar_data_callback callback, void* context,
                                      uint32_t* subscription)
{
    return c::enter(client, [&]() -> StatusCode {
        if (callback == nullptr || subscription == nullptr || !c::is_interval(interval_ms)) {
            return status::Bad_InvalidArgument;
        }
        client::SubscriptionSettings settings;
        settings.publishing_interval = std::chrono::duration<double, std::milli>{interval_ms};
        const auto feed = std::make_shared<c::Feed>(c::Feed{client, callback, context});
        client::Subscriptions& subscriptions = client->client->client().subscriptions();
        const auto created = subscriptions.create(settings, c::handlers_of(feed));
        *subscription = created.value_or(0);
        if (!created) {
            return created.error();
        }
        busbar::detail::Undo undo{[&] { static_cast<void>(subscriptions.remove(*created)); }};
        client->feeds.emplace(*created, feed);
        undo.keep();
        return status::Good;
    });
}

busbar_status busbar_client_monitor(busbar_client* client, uint32_t subscription, const char* node,
                                    double sampling_ms, uint32_t queue_size, uint32_t* item)
{
    return c::enter(client, [&]() -> StatusCode {
        if (node == nullptr || item == nullptr ||
            !(sampling_ms < 0 || c::is_interval(sampling_ms))) {
            return status::Bad_InvalidArgument;
        }
        auto address = client::NodeAddress::parse(node);
        if (!address) {
            return address.error();
        }
        client::ItemSettings settings;
        settings.node = *std::move(address);
        settings.sampling_interval =
            std::chrono::duration<double, std::milli>{sampling_ms < 0 ? -1 : sampling_ms};
        settings.queue_size = queue_size == 0 ? 1 : queue_size;
        std::vector<client::ItemSettings> items;
        items.push_back(std::move(settings));
        const auto added =
            client->client->client().subscriptions().add_items(subscription, std::move(items));
        *item = added ? added->front() : 0;
        return added ? status::Good : added.error();
    });
}

busbar_status busbar_client_unsubscribe(busbar_client* client, uint32_t subscription)
{
    return c::enter(client, [&]() -> StatusCode {
        const auto removed = client->client->client().subscriptions().remove(subscription);
        if (!removed) {
            return removed.error();
        }
        if (const auto feed = client->feeds.find(subscription); feed != client->feeds.end()) {
            feed->second->has_ended = true;
            client->feeds.erase(feed);
        }
        return status::Good;
    });
}
