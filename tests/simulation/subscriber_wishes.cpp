#include <algorithm>
#include <utility>

#include "subscriber.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

using State = Watch::State;

double draw_interval(Chance& chance)
{
    return chance.pick({5'000.0, 10'000.0, 20'000.0, 40'000.0});
}

} // namespace

void Subscriber::next_step()
{
    if (!is_ready_ || is_busy_) {
        return;
    }
    const bool needs_transfer =
        std::any_of(subscriptions_.begin(), subscriptions_.end(),
                    [](const auto& entry) { return entry.second.needs_transfer; });
    if (needs_transfer) {
        return transfer();
    }
    fill_publish_queue();
    if (!is_ready_ || is_busy_ || republish()) {
        return;
    }
    for (auto& [id, subscription] : subscriptions_) {
        if (adjust(subscription)) {
            return;
        }
    }
    if (subscriptions_.size() < habits_.subscriptions && !is_calm_) {
        create_subscription();
    }
}

/// True if there was something to ask for.
bool Subscriber::adjust(WatchedSubscription& subscription)
{
    if (subscription.needs_values) {
        resend(subscription);
        return true;
    }
    if (subscription.interval != subscription.wanted_interval) {
        modify_subscription(subscription);
        return true;
    }
    if (subscription.publishing != subscription.wants_publishing) {
        set_publishing(subscription);
        return true;
    }
    for (const auto& [handle, watch] : subscription.watches) {
        if (adjust(subscription, handle)) {
            return true;
        }
    }
    wish_for_items(subscription);
    return create_items(subscription);
}

bool Subscriber::adjust(WatchedSubscription& subscription, std::uint32_t handle)
{
    const Watch& watch = subscription.watches.at(handle);
    if (watch.state == State::Unwanted) {
        delete_item(subscription, handle);
        return true;
    }
    if (watch.state != State::Live) {
        return false;
    }
    if (watch.mode != watch.wanted_mode) {
        set_mode(subscription, handle);
        return true;
    }
    if (watch.queue_size != watch.wanted_queue_size) {
        modify_item(subscription, handle);
        return true;
    }
    return false;
}

void Subscriber::wish_for_items(WatchedSubscription& subscription)
{
    using Kind = Plant::Kind;
    for (const Kind kind : {Kind::Scan, Kind::Memory, Kind::Event}) {
        const bool is_there = std::any_of(
            subscription.watches.begin(), subscription.watches.end(), [&](const auto& entry) {
                return entry.second.kind == kind && entry.second.state != State::Gone;
            });
        if (!is_there) {
            const std::size_t counter = kind == Kind::Event ? 0 : chance_.below(Plant::counters);
            const std::uint32_t queue_size = chance_.pick({5U, 12U, 50U});
            subscription.add_watch(kind, counter, habits_.is_saturated ? 5 : queue_size);
        }
    }
    for (std::size_t i = 0; i < Plant::counters && subscription.is_saturated; ++i) {
        const bool is_there = std::any_of(
            subscription.watches.begin(), subscription.watches.end(), [&](const auto& entry) {
                return entry.second.kind == Kind::Storm && entry.second.counter == i &&
                       entry.second.state != State::Gone;
            });
        if (!is_there) {
            subscription.add_watch(Kind::Storm, i, 5);
        }
    }
}

void Subscriber::create_subscription()
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = draw_interval(chance_);
    request.requested_max_keep_alive_count = static_cast<std::uint32_t>(3 + chance_.below(8));
    request.requested_lifetime_count = static_cast<std::uint32_t>(chance_.below(200));
    request.max_notifications_per_publish = chance_.pick({0U, 0U, 2U});
    request.priority = static_cast<std::uint8_t>(chance_.below(3));
    request.publishing_enabled = true;
    const bool is_saturated =
        habits_.is_saturated &&
        std::none_of(subscriptions_.begin(), subscriptions_.end(),
                     [](const auto& entry) { return entry.second.is_saturated; });
    if (habits_.is_saturated) {
        // The others have their turn, and little to send.
        request.priority = 1;
        request.max_notifications_per_publish = is_saturated ? 2 : 0;
    }
    step<CreateSubscriptionResponse>(request, [this, request, is_saturated](auto response) {
        expect(response.has_value(), "CreateSubscription",
               response ? StatusCode{} : response.error());
        if (!response) {
            return;
        }
        const std::uint32_t id = response->subscription_id;
        const auto kept = static_cast<std::uint32_t>(
            parts_.host.server().config().limits.subscriptions.max_retransmission_messages);
        auto& made = subscriptions_.try_emplace(id, id, kept).first->second;
        made.wanted_interval = request.requested_publishing_interval;
        made.interval = response->revised_publishing_interval;
        made.shortest_interval = made.longest_interval = made.wanted_interval;
        made.keep_alive_count = response->revised_max_keep_alive_count;
        made.lifetime_count = response->revised_lifetime_count;
        made.max_notifications = request.max_notifications_per_publish;
        made.priority = request.priority;
        made.is_saturated = is_saturated;
        made.last_use = last_use_;
        made.undisturbed_since = made.created = parts_.scheduler.now();
        parts_.trace.note(number_, "created", id);
    });
}

bool Subscriber::create_items(WatchedSubscription& subscription)
{
    CreateMonitoredItemsRequest request;
    std::vector<std::uint32_t> handles;
    for (auto& [handle, watch] : subscription.watches) {
        if (watch.state != State::Wanted) {
            continue;
        }
        MonitoredItemCreateRequest item;
        item.item_to_monitor.node_id = parts_.plant.node(watch.kind, watch.counter);
        item.item_to_monitor.attribute_id = watch.kind == Plant::Kind::Event ? 12 : 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters = parameters_of(watch, handle);
        request.items_to_create.push_back(std::move(item));
        handles.push_back(handle);
        watch.state = State::Asked;
    }
    if (handles.empty()) {
        return false;
    }
    request.subscription_id = subscription.id;
    step<CreateMonitoredItemsResponse>(request,
                                       [this, id = subscription.id, handles](auto response) {
                                           items_created(id, handles, response);
                                       });
    return true;
}

void Subscriber::items_created(std::uint32_t id, const std::vector<std::uint32_t>& handles,
                               const Result<CreateMonitoredItemsResponse>& response)
{
    WatchedSubscription* const subscription = find(id);
    if (subscription == nullptr || (!response && is_subscription_lost(id, response.error()))) {
        return;
    }
    if (!response || response->results.size() != handles.size()) {
        return violation("CreateMonitoredItems");
    }
    subscription->last_use = std::max(subscription->last_use, last_use_);
    for (std::size_t i = 0; i < handles.size(); ++i) {
        Watch& watch = subscription->watches.at(handles[i]);
        const MonitoredItemCreateResult& result = response->results[i];
        if (is_refused(result.status_code)) {
            watch.state = State::Wanted;
            continue;
        }
        expect(result.status_code == status::Good &&
                   result.revised_queue_size == watch.wanted_queue_size,
               "an item was not created", result.status_code);
        watch.state = State::Live;
        watch.item_id = result.monitored_item_id;
        watch.queue_size = watch.wanted_queue_size;
        watch.mode = MonitoringMode::Reporting;
        watch.first_count = parts_.plant.count(watch.kind, watch.counter);
        watch.since = parts_.scheduler.now();
    }
}

void Subscriber::modify_subscription(WatchedSubscription& subscription)
{
    ModifySubscriptionRequest request;
    request.subscription_id = subscription.id;
    request.requested_publishing_interval = subscription.wanted_interval;
    request.requested_lifetime_count = subscription.lifetime_count;
    request.requested_max_keep_alive_count = subscription.keep_alive_count;
    request.max_notifications_per_publish = subscription.max_notifications;
    request.priority = subscription.priority;
    subscription.interval.reset();
    subscription.shortest_interval =
        std::min(subscription.shortest_interval, subscription.wanted_interval);
    subscription.longest_interval =
        std::max(subscription.longest_interval, subscription.wanted_interval);
    step<ModifySubscriptionResponse>(
        request, [this, id = subscription.id](Result<ModifySubscriptionResponse> response) {
            WatchedSubscription* const found = find(id);
            if (found == nullptr || (!response && is_subscription_lost(id, response.error()))) {
                return;
            }
            expect(response && response->revised_lifetime_count == found->lifetime_count,
                   "ModifySubscription", response ? StatusCode{} : response.error());
            found->interval = response ? response->revised_publishing_interval : 0;
            found->undisturbed_since = parts_.scheduler.now();
        });
}

void Subscriber::set_publishing(WatchedSubscription& subscription)
{
    SetPublishingModeRequest request;
    request.publishing_enabled = subscription.wants_publishing;
    request.subscription_ids = {subscription.id};
    subscription.publishing.reset();
    const bool wanted = subscription.wants_publishing;
    step<SetPublishingModeResponse>(request, [this, id = subscription.id, wanted](auto response) {
        WatchedSubscription* const found = find(id);
        const StatusCode status = response ? response->results[0] : response.error();
        if (found != nullptr && !is_subscription_lost(id, status) && !is_refused(status)) {
            expect(status == status::Good, "SetPublishingMode", status);
            found->publishing = wanted;
            found->undisturbed_since = parts_.scheduler.now();
        }
    });
}

void Subscriber::set_mode(WatchedSubscription& subscription, std::uint32_t handle)
{
    Watch& watch = subscription.watches.at(handle);
    const MonitoringMode wanted = watch.wanted_mode;
    if (wanted == MonitoringMode::Disabled) {
        watch.check.allow_gap();
    }
    watch.mode.reset();
    SetMonitoringModeRequest request;
    request.subscription_id = subscription.id;
    request.monitoring_mode = wanted;
    request.monitored_item_ids = {watch.item_id};
    step<SetMonitoringModeResponse>(
        request, [this, id = subscription.id, handle, wanted](auto response) {
            const StatusCode status = response ? response->results[0] : response.error();
            Watch* const found = find(id, handle);
            if (found != nullptr && !is_subscription_lost(id, status) && !is_refused(status)) {
                expect(status == status::Good, "SetMonitoringMode", status);
                found->mode = wanted;
                found->since = parts_.scheduler.now();
            }
        });
}

void Subscriber::modify_item(WatchedSubscription& subscription, std::uint32_t handle)
{
    Watch& watch = subscription.watches.at(handle);
    const std::uint32_t wanted = watch.wanted_queue_size;
    watch.queue_size.reset();
    ModifyMonitoredItemsRequest request;
    request.subscription_id = subscription.id;
    request.items_to_modify.resize(1);
    request.items_to_modify[0].monitored_item_id = watch.item_id;
    request.items_to_modify[0].requested_parameters = parameters_of(watch, handle);
    step<ModifyMonitoredItemsResponse>(request, [this, id = subscription.id, handle,
                                                 wanted](auto response) {
        const StatusCode status = response ? response->results[0].status_code : response.error();
        Watch* const found = find(id, handle);
        if (found != nullptr && !is_subscription_lost(id, status) && !is_refused(status)) {
            expect(status == status::Good, "ModifyMonitoredItems", status);
            found->queue_size = wanted;
        }
    });
}

void Subscriber::delete_item(WatchedSubscription& subscription, std::uint32_t handle)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = subscription.id;
    request.monitored_item_ids = {subscription.watches.at(handle).item_id};
    step<DeleteMonitoredItemsResponse>(
        request, [this, id = subscription.id, handle](auto response) {
            const StatusCode status = response ? response->results[0] : response.error();
            Watch* const found = find(id, handle);
            if (found != nullptr && !is_subscription_lost(id, status) && !is_refused(status)) {
                // Unknown, if the answer to an earlier request was lost.
                expect(status == status::Good || status == status::Bad_MonitoredItemIdInvalid,
                       "DeleteMonitoredItems", status);
                found->state = State::Gone;
            }
        });
}

void Subscriber::delete_subscription(std::uint32_t id)
{
    subscriptions_.erase(id);
    if (!orphans_.insert(id).second) {
        return;
    }
    DeleteSubscriptionsRequest request;
    request.subscription_ids = {id};
    call<DeleteSubscriptionsResponse>(request, [this, id](auto) { orphans_.erase(id); });
}

void Subscriber::change_mind()
{
    mind_.set_after(chance_.between(2min, 30min));
    const auto away = chance_.pick<Duration>(
        {chance_.between(1s, 30s), chance_.between(1min, 14min), chance_.between(16min, 70min)});
    const std::size_t what = chance_.below(10);
    if (!is_ready_ || is_busy_ || subscriptions_.empty()) {
        return;
    }
    auto& subscription =
        std::next(subscriptions_.begin(),
                  static_cast<std::ptrdiff_t>(chance_.below(subscriptions_.size())))
            ->second;
    if (what <= 1) {
        return go_away(away);
    }
    if (what == 2) {
        return change_session();
    }
    if (what == 3) {
        delete_subscription(subscription.id);
    } else if (what == 4) {
        subscription.wanted_interval = draw_interval(chance_);
    } else if (what == 5) {
        subscription.wants_publishing = !subscription.wants_publishing;
    } else {
        change_item(subscription);
    }
    next_step();
}

void Subscriber::change_item(WatchedSubscription& subscription)
{
    const std::size_t what = chance_.below(3);
    const auto mode = chance_.pick(
        {MonitoringMode::Reporting, MonitoringMode::Sampling, MonitoringMode::Disabled});
    const std::uint32_t queue_size = chance_.pick({5U, 12U, 50U});
    const std::size_t chosen = chance_.below(subscription.watches.size() + 1);
    auto found = subscription.watches.begin();
    std::advance(found, static_cast<std::ptrdiff_t>(chosen));
    if (found == subscription.watches.end() || found->second.state != State::Live) {
        return;
    }
    Watch& watch = found->second;
    if (what == 0) {
        watch.state = State::Unwanted;
    } else if (what == 1) {
        watch.wanted_mode = mode;
    } else {
        watch.wanted_queue_size = habits_.is_saturated ? 5 : queue_size;
    }
}

} // namespace busbar::test
