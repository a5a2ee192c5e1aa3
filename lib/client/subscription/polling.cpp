#include <algorithm>
#include <cmath>

#include "polling.hpp"

namespace busbar::client::detail {

namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

// "As fast as possible", without an interval (Part 4, 7.21), does not suit Read.
constexpr Milliseconds shortest_interval{50};
constexpr Milliseconds longest_interval{std::chrono::hours{24}};

Duration poll_interval(const ItemParameters& parameters, const SubscriptionSettings& settings)
{
    Milliseconds interval{parameters.sampling_interval};
    if (!(interval.count() >= 0)) {
        interval = settings.publishing_interval; // Part 4, 7.21: -1 is the publishing interval
    }
    if (!(interval >= shortest_interval)) {
        interval = shortest_interval;
    }
    return std::chrono::duration_cast<Duration>(std::min(interval, longest_interval));
}

} // namespace

ItemPolling::ItemPolling(SessionRequests& requests, WatchList& subscriptions, ItemTable& items)
    : requests_{requests}, subscriptions_{subscriptions}, items_{items},
      max_batch_{SessionRequests::default_batch}
{
}

void ItemPolling::begin_session()
{
    max_batch_ = SessionRequests::default_batch;
}

void ItemPolling::start(WatchedSubscription& subscription)
{
    subscription.phase = Phase::Polling;
    ++subscription.incarnation;
    subscription.polls.clear();
    subscription.queue_all_items(items_);
    requests_.call_for_work();
    CreateSubscriptionResponse response;
    response.revised_publishing_interval = subscription.settings.publishing_interval.count();
    subscription.report_status(status::Good, response);
}

ItemStatus ItemPolling::add(WatchedSubscription& subscription, ItemHandle handle,
                            const NodeId& node)
{
    Item& item = *items_.find(handle);
    if (item.parameters->has_events()) {
        return {status::Bad_ServiceUnsupported, 0, 0, {}};
    }
    const PollKey key{poll_interval(*item.parameters, subscription.settings),
                      item.parameters->timestamps};
    item.is_created = true;
    PolledItem polled;
    polled.handle = handle;
    polled.version = ++item.poll_version;
    polled.node = node;
    subscription.polls[key].items.push_back(std::move(polled));
    return {status::Good, Milliseconds{key.interval}.count(), 1, {}};
}

void ItemPolling::poll(WatchedSubscription& subscription, TimePoint now)
{
    for (auto next = subscription.polls.begin(); next != subscription.polls.end();) {
        auto& [key, group] = *next;
        if (group.is_reading || group.due > now) {
            ++next;
            continue;
        }
        // Removed items, and those that were moved to another place.
        std::erase_if(group.items, [&](const PolledItem& polled) {
            const Item* item = items_.find(polled.handle);
            return item == nullptr || item->poll_version != polled.version;
        });
        if (group.items.empty()) {
            next = subscription.polls.erase(next);
            continue;
        }
        group.position = 0;
        group.due = now + key.interval;
        read(subscription, key);
        ++next;
    }
}

/// Requests the next items of a round, as many as a Read may have.
void ItemPolling::read(WatchedSubscription& subscription, const PollKey& key)
{
    PollGroup& group = subscription.polls[key];
    const std::size_t allowed = requests_.server().operation_limits.max_nodes_per_read;
    const std::size_t limit = allowed == 0 ? max_batch_ : std::min(allowed, max_batch_);
    ReadRequest request;
    request.timestamps_to_return = key.timestamps;
    std::vector<std::size_t> places;
    for (; group.position < group.items.size() && places.size() < limit; ++group.position) {
        const PolledItem& polled = group.items[group.position];
        const Item* item = items_.find(polled.handle);
        if (item != nullptr && item->mode == MonitoringMode::Reporting) {
            places.push_back(group.position);
            request.nodes_to_read.push_back(
                {polled.node,
                 static_cast<std::uint32_t>(item->parameters->attribute),
                 item->parameters->index_range,
                 {}});
        }
    }
    group.is_reading = !places.empty();
    if (!places.empty()) {
        requests_.send<ReadResponse>(
            std::move(request),
            [this, key, places = std::move(places), handle = subscription.handle,
             incarnation = subscription.incarnation](const auto& response) {
                if (WatchedSubscription* found = subscriptions_.find(handle, incarnation)) {
                    values_read(*found, key, places, response);
                }
            });
    }
}

void ItemPolling::values_read(WatchedSubscription& subscription, const PollKey& key,
                              const std::vector<std::size_t>& places,
                              const Result<ReadResponse>& response)
{
    PollGroup& group = subscription.polls[key];
    group.is_reading = false;
    if (!response || response->results.size() != places.size()) {
        max_batch_ = std::max<std::size_t>(places.size() / 2, 1); // the next round may fit
        return;
    }
    const SubscriptionHandle handle = subscription.handle;
    const auto changes = changes_in(group, places, *response);
    const DateTime time = response->response_header.timestamp;
    const auto handlers = subscription.handlers;
    subscription.report_gap(time);
    if (handlers->on_data && !changes.empty()) {
        handlers->on_data(changes);
    }
    if (WatchedSubscription* rest = subscriptions_.find(handle);
        rest != nullptr && rest->phase == Phase::Polling) {
        rest->messages.complete_until = time;
        read(*rest, key);
    }
}

std::vector<DataChange> ItemPolling::changes_in(PollGroup& group,
                                                const std::vector<std::size_t>& places,
                                                const ReadResponse& response)
{
    std::vector<DataChange> changes;
    for (std::size_t i = 0; i < places.size(); ++i) {
        PolledItem& polled = group.items[places[i]];
        const Item* item = items_.find(polled.handle);
        const bool is_due =
            item != nullptr && item->poll_version == polled.version &&
            (!polled.has_value || is_change(*item->parameters, polled.last, response.results[i]));
        if (is_due) {
            polled.has_value = true;
            polled.last = response.results[i];
            changes.push_back({polled.handle, response.results[i]});
        }
    }
    return changes;
}

} // namespace busbar::client::detail
