#include <algorithm>

#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "client/request_queue.hpp"
#include "value_refresh.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t max_refreshes = 3;
// However often notifications are lost, no server is asked for all values more often.
constexpr Duration refresh_pause = std::chrono::seconds{1};

StatusCode outcome_of(const Result<CallResponse>& response)
{
    if (!response) {
        return response.error();
    }
    return response->results.size() == 1 ? response->results[0].status_code
                                         : StatusCode{status::Bad_UnknownResponse};
}

} // namespace

ValueRefresh::ValueRefresh(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
                           SubscriptionEnds& ends, ItemRequests& item_requests)
    : requests_{requests}, subscriptions_{subscriptions}, items_{items}, ends_{ends},
      item_requests_{item_requests}
{
}

void ValueRefresh::refresh(WatchedSubscription& subscription)
{
    Refresh& refresh = subscription.refresh;
    const bool may_ask = requests_.has_session() && subscription.phase == Phase::Live &&
                         subscription.is_publishing && !subscription.messages.is_catching_up &&
                         !subscription.messages.loss && !refresh.is_under_way &&
                         requests_.now() >= refresh.at;
    if (!may_ask) {
        return;
    }
    if (refresh.is_reading()) {
        read_again(subscription);
    } else if (std::exchange(refresh.is_due, false) && subscription.handlers->on_data) {
        ask_again(subscription);
    }
}

void ValueRefresh::ask_again(WatchedSubscription& subscription)
{
    const bool is_needed =
        std::any_of(subscription.items.begin(), subscription.items.end(),
                    [&](ItemHandle handle) { return is_stale(subscription, handle); });
    if (is_needed && has_resend_data_) {
        call_resend_data(subscription);
    } else if (is_needed) {
        queue_stale_items(subscription);
        read_again(subscription);
    }
}

/// True if the item reports values, and has had none since some were lost.
bool ValueRefresh::is_stale(const WatchedSubscription& subscription, ItemHandle handle)
{
    const Item* item = items_.find(handle);
    return item != nullptr && item->subscription == subscription.handle && item->is_created &&
           item->mode == MonitoringMode::Reporting && !item->parameters->has_events() &&
           item->told_after != subscription.refresh.losses;
}

/// Part 5, 9.2: the values arrive in notifications.
void ValueRefresh::call_resend_data(WatchedSubscription& subscription)
{
    CallMethodRequest method;
    method.object_id = NodeId{0, id::Server};
    method.method_id = NodeId{0, id::Server_ResendData};
    method.input_arguments.emplace_back(subscription.server_id);
    CallRequest request;
    request.methods_to_call.push_back(std::move(method));
    subscription.refresh.is_under_way = true;
    requests_.send<CallResponse>(
        std::move(request), [this, handle = subscription.handle,
                             incarnation = subscription.incarnation](const auto& response) {
            if (WatchedSubscription* found = subscriptions_.find(handle, incarnation)) {
                resend_answered(*found, outcome_of(response));
            }
        });
}

void ValueRefresh::resend_answered(WatchedSubscription& subscription, StatusCode status)
{
    Refresh& refresh = subscription.refresh;
    refresh.is_under_way = false;
    refresh.at = requests_.now() + refresh_pause;
    if (!status.is_bad()) {
        refresh.failures = 0;
    } else if (status == status::Bad_SubscriptionIdInvalid) {
        ends_.lost(subscription, status, false);
    } else if (is_unanswered(status) && refresh.failures + 1 < max_refreshes) {
        ++refresh.failures;
        refresh.is_due = true;
    } else {
        // For any reason, since a Read needs neither the Method nor the right to call it.
        has_resend_data_ = is_unanswered(status);
        refresh.failures = 0;
        refresh.at = {};
        queue_stale_items(subscription);
    }
}

void ValueRefresh::queue_stale_items(WatchedSubscription& subscription)
{
    for (const ItemHandle handle : subscription.items) {
        if (is_stale(subscription, handle)) {
            const ItemParameters& parameters = *items_.find(handle)->parameters;
            if (parameters.is_readable()) {
                const auto timestamps = static_cast<std::size_t>(parameters.timestamps);
                subscription.refresh.to_read[timestamps].push_back(handle);
            }
        }
    }
}

/// Reads the next items that are still without a value, as many as a Read may have.
void ValueRefresh::read_again(WatchedSubscription& subscription)
{
    const std::size_t allowed = requests_.server().operation_limits.max_nodes_per_read;
    const std::size_t limit = allowed == 0 ? SessionRequests::default_batch
                                           : std::min(allowed, SessionRequests::default_batch);
    std::vector<ItemHandle> items;
    std::vector<NodeAddress> addresses;
    ReadSettings settings;
    for (std::size_t i = 0; i < ItemWork::timestamps_count && items.empty(); ++i) {
        settings.timestamps = static_cast<TimestampsToReturn>(i);
        auto& queue = subscription.refresh.to_read[i];
        for (; !queue.empty() && items.size() < limit; queue.pop_front()) {
            if (is_stale(subscription, queue.front())) {
                items.push_back(queue.front());
                addresses.push_back(items_.find(queue.front())->node);
            }
        }
    }
    if (items.empty()) {
        return;
    }
    subscription.refresh.is_under_way = true;
    item_requests_.resolve_nodes(subscription, std::move(addresses),
                                 [this, items = std::move(items), settings,
                                  handle = subscription.handle](const auto& nodes) {
                                     read_again(*subscriptions_.find(handle), items, nodes,
                                                settings);
                                 });
}

void ValueRefresh::read_again(WatchedSubscription& subscription,
                              const std::vector<ItemHandle>& items,
                              const std::vector<Result<NodeId>>& nodes,
                              const ReadSettings& settings)
{
    std::vector<ReadValueId> asked;
    std::vector<DataChange> values; // only items that are requested first
    std::vector<DataChange> unresolved;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Item* item = items_.find(items[i]);
        if (item != nullptr && nodes[i]) {
            const ItemParameters& parameters = *item->parameters;
            asked.push_back(
                attribute_of(*nodes[i], parameters.attribute, parameters.index_range.view()));
            values.push_back({items[i], {}, true});
        } else if (item != nullptr) {
            unresolved.push_back({items[i], DataValue{nodes[i].error()}, true});
        }
    }
    values.insert(values.end(), unresolved.begin(), unresolved.end());
    RequestOptions at_once;
    at_once.waits_for_session = false;
    subscription.refresh.read = client::read(
        requests_.requester(), std::move(asked),
        [this, values = std::move(values), guard = item_requests_.guard(subscription),
         handle = subscription.handle,
         losses = subscription.refresh.losses](std::vector<DataValue> answers) mutable {
            if (!guard()) {
                return;
            }
            for (std::size_t i = 0; i < answers.size(); ++i) {
                values[i].value = std::move(answers[i]);
            }
            requests_.watch([&] { deliver_read(handle, values, losses); });
        },
        settings, at_once);
}

/// `losses`: the number of losses when the values were requested.
void ValueRefresh::deliver_read(SubscriptionHandle handle, const std::vector<DataChange>& values,
                                std::uint32_t losses)
{
    WatchedSubscription& subscription = *subscriptions_.find(handle);
    Refresh& refresh = subscription.refresh;
    refresh.is_under_way = false;
    bool is_again = false;
    std::vector<DataChange> changes;
    for (const DataChange& value : values) {
        Item* item = items_.find(value.item);
        // If a notification arrived meanwhile, another one brings newer values.
        if (item == nullptr || item->mode != MonitoringMode::Reporting ||
            item->told_after >= losses) {
            continue;
        }
        if (is_unanswered(value.value.status) && refresh.failures + 1 < max_refreshes) {
            refresh.to_read[static_cast<std::size_t>(item->parameters->timestamps)].push_back(
                value.item);
            is_again = true;
        } else {
            item->told_after = losses;
            changes.push_back(value);
        }
    }
    refresh.failures = is_again ? refresh.failures + 1 : 0;
    const bool is_pause = is_again || !refresh.is_reading();
    refresh.at = is_pause ? requests_.now() + refresh_pause : TimePoint{};
    requests_.call_for_work();
    const auto handlers = subscription.handlers;
    if (!changes.empty()) {
        handlers->on_data(changes);
    }
}

} // namespace busbar::client::detail
