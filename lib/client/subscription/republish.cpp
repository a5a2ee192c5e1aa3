#include <algorithm>

#include "engine.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t max_republishes = 3;
constexpr std::uint32_t patient_silences = 2;

/// The server answered, and the message is not to be had.
bool is_final(StatusCode status)
{
    return status == status::Bad_MessageNotAvailable ||
           status == status::Bad_SequenceNumberUnknown ||
           status == status::Bad_ServiceUnsupported || status == status::Bad_NotImplemented ||
           status == status::Bad_NotSupported || status == status::Bad_DecodingError ||
           status == status::Bad_EncodingLimitsExceeded || status == status::Bad_ResponseTooLarge;
}

} // namespace

/// Notifications after complete_until are lost; the Gap ends with the next one.
void SubscriptionEngine::lose(WatchedSubscription& subscription, StatusCode reason)
{
    ++subscription.refresh.losses;
    subscription.refresh.is_due = true;
    if (!subscription.loss) {
        subscription.loss = Loss{reason, subscription.complete_until};
    }
}

void SubscriptionEngine::report_gap(WatchedSubscription& subscription, DateTime until)
{
    if (!subscription.loss) {
        return;
    }
    const Gap gap{
        subscription.handle, {}, subscription.loss->from, until, subscription.loss->reason};
    subscription.loss.reset();
    const auto handlers = subscription.handlers;
    if (handlers->on_gap) {
        handlers->on_gap(gap);
    }
}

/// After something was heard: asks for what is missing, or has all until now.
void SubscriptionEngine::settle(SubscriptionHandle handle)
{
    WatchedSubscription* subscription = find(handle);
    if (subscription == nullptr || subscription->phase != Phase::Live) {
        return;
    }
    fetch_missing(*subscription);
    const bool has_all_items = !subscription->is_busy && subscription->work.is_creation_done();
    if (has_all_items && !subscription->is_probing && !subscription->sequence.is_missing() &&
        subscription->is_publishing == subscription->settings.is_publishing_enabled) {
        subscription->complete_until = subscription->heard_time;
        report_gap(*subscription, subscription->heard_time);
    }
}

void SubscriptionEngine::fetch_missing(WatchedSubscription& subscription)
{
    const bool is_needed = subscription.is_probing || subscription.sequence.is_missing();
    subscription.is_catching_up = subscription.is_catching_up && is_needed;
    if (!has_session_ || subscription.phase != Phase::Live || subscription.is_republishing ||
        !is_needed || requester_.now() < subscription.republish_at) {
        return;
    }
    const std::uint32_t number = subscription.sequence.next();
    // Of a message that nobody has heard of yet, Bad_MessageNotAvailable means nothing.
    const bool is_sent = subscription.sequence.is_missing();
    RepublishRequest request;
    request.subscription_id = subscription.server_id;
    request.retransmit_sequence_number = number;
    subscription.is_republishing = true;
    send<RepublishResponse>(request, [this, number, is_sent, handle = subscription.handle,
                                      incarnation = subscription.incarnation](const auto& r) {
        if (WatchedSubscription* found = find(handle, incarnation)) {
            found->is_republishing = false;
            republished(*found, number, is_sent, r);
        }
        WatchedSubscription* found = find(handle, incarnation);
        if (found != nullptr && found->heard_time > found->complete_until) {
            settle(handle); // what was told of since is here, or is given up
        } else if (found != nullptr) {
            fetch_missing(*found);
        }
    });
}

void SubscriptionEngine::republished(WatchedSubscription& subscription, std::uint32_t number,
                                     bool is_sent, const Result<RepublishResponse>& response)
{
    if (!response && response.error() == status::Bad_SubscriptionIdInvalid) {
        lost(subscription, response.error(), false);
    } else if (number != subscription.sequence.next()) {
        return; // a Publish response has brought it since
    } else if (!response) {
        not_republished(subscription, is_sent, response.error());
    } else if (response->notification_message.sequence_number != number) {
        not_republished(subscription, is_sent, status::Bad_MessageNotAvailable);
    } else {
        subscription.republish_failures = 0;
        if (++subscription.probe_count >= limits_.max_missing) {
            subscription.is_probing = false; // a server that never ends
        }
        NotificationMessage message = response->notification_message;
        if (message.publish_time.is_null()) {
            message.publish_time = response->response_header.timestamp;
        }
        accept(subscription.handle, std::move(message));
    }
}

void SubscriptionEngine::not_republished(WatchedSubscription& subscription, bool is_sent,
                                         StatusCode status)
{
    if (!is_final(status) && ++subscription.republish_failures < max_republishes) {
        subscription.republish_at = requester_.now() + pause_after_failure;
        return;
    }
    subscription.republish_failures = 0;
    if (is_sent) {
        lose(subscription, status::Bad_MessageNotAvailable);
        subscription.sequence.skip();
        deliver_kept(subscription.handle);
    } else {
        subscription.is_probing = false; // there is nothing more
    }
}

/// Part 4, 5.14.1.1: whatever happens, something comes within the keep-alive interval.
void SubscriptionEngine::watch(WatchedSubscription& subscription, TimePoint now)
{
    if (subscription.phase != Phase::Live || now < subscription.silent_at) {
        fetch_missing(subscription);
        return;
    }
    const DateTime time = subscription.heard_time;
    const std::uint32_t silences = subscription.silences + 1;
    heard(subscription, time);
    subscription.silences = silences;
    if (silences >= patient_silences) {
        renew_publishes();
    }
    subscription.is_probing = true;
    subscription.probe_count = 0;
    fetch_missing(subscription);
}

} // namespace busbar::client::detail
