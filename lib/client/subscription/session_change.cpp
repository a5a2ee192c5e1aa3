#include "session_change.hpp"

namespace busbar::client::detail {

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
    // Values that were delivered must not come again; what is missing comes by Republish.
    TransferSubscriptionsRequest request;
    request.send_initial_values = false;
    for (const auto& [handle, subscription] : subscriptions_.all()) {
        if (subscription.phase == Phase::Transferring) {
            handles.push_back(handle);
            request.subscription_ids.push_back(subscription.server_id);
        }
    }
    if (handles.empty()) {
        return;
    }
    requests_.send<TransferSubscriptionsResponse>(
        std::move(request), [this, handles = std::move(handles)](const auto& response) {
            transferred(handles, response);
        });
}

void SessionChange::transferred(const std::vector<SubscriptionHandle>& handles,
                                const Result<TransferSubscriptionsResponse>& response)
{
    if (!response && response.error() == status::Bad_Timeout) {
        transfer();
        return;
    }
    if (!response && (response.error() == status::Bad_ConnectionClosed ||
                      response.error() == status::Bad_SecureChannelClosed)) {
        return; // the next session tries it
    }
    for (std::size_t i = 0; i < handles.size(); ++i) {
        WatchedSubscription* subscription = subscriptions_.find(handles[i]);
        if (subscription == nullptr || subscription->phase != Phase::Transferring) {
            continue;
        }
        if (!response) {
            ends_.lost(*subscription, response.error(), true);
            continue;
        }
        const StatusCode result = i < response->results.size()
                                      ? response->results[i].status_code
                                      : StatusCode{status::Bad_UnexpectedError};
        // Bad_NothingToDo: it is this session's since a request whose answer was lost.
        if (result.is_bad() && result != status::Bad_NothingToDo) {
            // A server that has none of that id may give it to the next one.
            ends_.lost(*subscription, result, result != status::Bad_SubscriptionIdInvalid);
        } else {
            transferred(*subscription, response->results[i]);
        }
    }
}

void SessionChange::transferred(WatchedSubscription& subscription, const TransferResult& result)
{
    subscription.phase = Phase::Live;
    // Numbers that are too far ahead are not believed until a message has one.
    for (const std::uint32_t number : result.available_sequence_numbers) {
        subscription.messages.sequence.expect_through(number);
    }
    reception_.catch_up(subscription);
}

} // namespace busbar::client::detail
