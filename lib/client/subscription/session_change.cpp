#include "subscription_setup.hpp"

namespace busbar::client::detail {

namespace {

/// Number of attempts with a server that has no memory, once a second, or does not answer:
/// meanwhile nothing is published, as the messages of transferred Subscriptions have precedence.
constexpr std::uint32_t most_transfers = 10;

} // namespace

SessionChange::SessionChange(SessionRequests& requests, WatchList& subscriptions,
                             SubscriptionEnds& ends, Reception& reception)
    : requests_{requests}, subscriptions_{subscriptions}, ends_{ends}, reception_{reception}
{
}

void SessionChange::begin(bool is_new_session)
{
    subscriptions_.for_each(
        [&](WatchedSubscription& subscription) { start_again(subscription, is_new_session); });
    transfer();
}

void SessionChange::start_again(WatchedSubscription& subscription, bool is_new_session)
{
    subscription.retry_at = {};
    subscription.messages.begin_session();
    const bool is_at_server = subscription.server_id != 0;
    if (is_at_server && subscription.is_uncertain) {
        // Another session cannot delete it, and may get one with its id.
        ends_.lost(subscription, status::Bad_SubscriptionIdInvalid, !is_new_session);
    } else if (is_at_server && (is_new_session || subscription.phase == Phase::Transferring)) {
        subscription.phase = Phase::Transferring;
        subscription.failures = 0;
    } else if (is_at_server) {
        reception_.catch_up(subscription);
    } else if (subscription.phase == Phase::Polling) {
        subscription.polls.clear();
        subscription.phase = Phase::Wished; // this one may have Subscriptions
        if (!subscription.messages.complete_until.is_null()) {
            subscription.lose(status::Bad_NoSubscription);
        }
    }
}

void SessionChange::transfer()
{
    std::vector<SubscriptionHandle> handles;
    // Delivered values must not arrive again; missing ones are fetched by Republish.
    TransferSubscriptionsRequest request;
    request.send_initial_values = false;
    for (const auto& [handle, subscription] : subscriptions_.all()) {
        if (subscription.phase == Phase::Transferring && !subscription.is_busy &&
            requests_.now() >= subscription.retry_at) {
            handles.push_back(handle);
            request.subscription_ids.push_back(subscription.server_id);
        }
    }
    if (handles.empty()) {
        return;
    }
    for (const SubscriptionHandle handle : handles) {
        subscriptions_.find(handle)->is_busy = true;
    }
    requests_.send<TransferSubscriptionsResponse>(
        std::move(request), [this, handles = std::move(handles)](const auto& response) {
            transferred(handles, response);
        });
}

void SessionChange::transferred(const std::vector<SubscriptionHandle>& handles,
                                const Result<TransferSubscriptionsResponse>& response)
{
    if (!response && (response.error() == status::Bad_ConnectionClosed ||
                      response.error() == status::Bad_SecureChannelClosed)) {
        return; // the next session tries it
    }
    for (const SubscriptionHandle handle : handles) {
        if (WatchedSubscription* subscription = subscriptions_.find(handle)) {
            subscription->is_busy = false;
        }
    }
    for (std::size_t i = 0; i < handles.size(); ++i) {
        WatchedSubscription* subscription = subscriptions_.find(handles[i]);
        if (subscription == nullptr || subscription->phase != Phase::Transferring) {
            continue;
        }
        if (!response) {
            refused(*subscription, response.error());
        } else if (i >= response->results.size()) {
            refused(*subscription, status::Bad_UnexpectedError);
        } else {
            transferred(*subscription, response->results[i]);
        }
    }
    transfer(); // those that were not answered
}

void SessionChange::refused(WatchedSubscription& subscription, StatusCode reason)
{
    const bool may_pass = reason == status::Bad_OutOfMemory || reason == status::Bad_Timeout;
    if (may_pass && ++subscription.failures < most_transfers) {
        if (reason == status::Bad_OutOfMemory) {
            subscription.retry_at = requests_.now() + first_retry;
        }
        return;
    }
    subscription.failures = 0; // those of creating it follow
    // A server that has none with this id may give the id to the next one.
    ends_.lost(subscription, reason, reason != status::Bad_SubscriptionIdInvalid);
}

void SessionChange::transferred(WatchedSubscription& subscription, const TransferResult& result)
{
    // Bad_NothingToDo: it belongs to this session since a request whose answer was lost.
    if (result.status_code.is_bad() && result.status_code != status::Bad_NothingToDo) {
        refused(subscription, result.status_code);
        return;
    }
    subscription.failures = 0;
    subscription.phase = Phase::Live;
    // Numbers that are too far ahead are ignored until a message has one.
    for (const std::uint32_t number : result.available_sequence_numbers) {
        subscription.messages.sequence.expect_through(number);
    }
    reception_.catch_up(subscription);
}

} // namespace busbar::client::detail
