#include <algorithm>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "reception.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t max_republishes = 3;
constexpr std::uint32_t patient_silences = 2;
constexpr std::uint32_t max_silences = 5;
constexpr std::uint32_t max_silences_of_others = 10;
constexpr Duration republish_pause = std::chrono::seconds{1};

/// True if the server answered, and the message is not available.
bool is_final(StatusCode status)
{
    return status == status::Bad_MessageNotAvailable ||
           status == status::Bad_SequenceNumberUnknown ||
           status == status::Bad_ServiceUnsupported || status == status::Bad_NotImplemented ||
           status == status::Bad_NotSupported || status == status::Bad_DecodingError ||
           status == status::Bad_EncodingLimitsExceeded || status == status::Bad_ResponseTooLarge;
}

} // namespace

/// Continues after a message: requests missing ones, or is complete until now.
void Reception::settle(SubscriptionHandle handle)
{
    WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr || subscription->phase != Phase::Live) {
        return;
    }
    fetch_missing(*subscription);
    const bool has_all_items = !subscription->is_busy && subscription->work.is_creation_done();
    if (has_all_items && !subscription->messages.is_probing &&
        !subscription->messages.sequence.is_missing() &&
        subscription->is_publishing == subscription->settings.is_publishing_enabled) {
        subscription->messages.complete_until = subscription->messages.heard_time;
        subscription->report_gap(subscription->messages.heard_time);
    }
}

void Reception::fetch_missing(WatchedSubscription& subscription)
{
    MessageStream& messages = subscription.messages;
    if (!messages.needs_republish() || !requests_.has_session() ||
        subscription.phase != Phase::Live || messages.is_republishing ||
        requests_.now() < messages.republish_at) {
        return;
    }
    const std::uint32_t number = messages.sequence.next();
    // For a message that is not known to exist, Bad_MessageNotAvailable means nothing.
    const bool is_sent = messages.sequence.is_missing();
    RepublishRequest request;
    request.subscription_id = subscription.server_id;
    request.retransmit_sequence_number = number;
    messages.is_republishing = true;
    requests_.send<RepublishResponse>(
        request, [this, number, is_sent, handle = subscription.handle,
                  incarnation = subscription.incarnation](const auto& response) {
            if (WatchedSubscription* found = subscriptions_.find(handle, incarnation)) {
                found->messages.is_republishing = false;
                republished(*found, number, is_sent, response);
            }
            go_on(handle, incarnation);
        });
}

void Reception::go_on(SubscriptionHandle handle, std::uint32_t incarnation)
{
    WatchedSubscription* const found = subscriptions_.find(handle, incarnation);
    if (found != nullptr && found->messages.heard_time > found->messages.complete_until) {
        settle(handle); // known messages have arrived, or are given up
    } else if (found != nullptr) {
        fetch_missing(*found);
    }
}

void Reception::republished(WatchedSubscription& subscription, std::uint32_t number, bool is_sent,
                            const Result<RepublishResponse>& response)
{
    if (!response && response.error() == status::Bad_SubscriptionIdInvalid) {
        ends_.lost(subscription, response.error(), false);
    } else if (number != subscription.messages.sequence.next()) {
        return; // a Publish response has brought it meanwhile
    } else if (!response) {
        not_republished(subscription, is_sent, response.error());
    } else if (response->notification_message.sequence_number != number) {
        not_republished(subscription, is_sent, status::Bad_MessageNotAvailable);
    } else {
        subscription.messages.republished();
        NotificationMessage message = response->notification_message;
        if (message.publish_time.is_null()) {
            message.publish_time = response->response_header.timestamp;
        }
        accept(subscription.handle, std::move(message));
    }
}

void Reception::not_republished(WatchedSubscription& subscription, bool is_sent, StatusCode status)
{
    subscription.messages.is_server_alive |= is_final(status);
    subscription.messages.has_sign |= status != status::Bad_Timeout;
    std::uint32_t& failures = subscription.messages.republish_failures;
    if (!is_final(status) && ++failures < max_republishes) {
        subscription.messages.republish_at = requests_.now() + republish_pause;
    } else if (status == status::Bad_Timeout && failures == max_republishes) {
        ask_for_life(subscription);
    } else {
        stop_republishing(subscription, is_sent);
    }
}

/// A server that does not answer at all may still have messages: the link delays everything.
/// Answers to Publish would push them out of the server's queue, so that none is sent before the
/// server answers something; then it has one more attempt.
void Reception::ask_for_life(WatchedSubscription& subscription)
{
    ReadRequest request;
    ReadValueId& state = request.nodes_to_read.emplace_back();
    state.node_id = NodeId{0, id::Server_ServerStatus_State};
    state.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    subscription.messages.is_republishing = true;
    requests_.send<ReadResponse>(
        request, [this, handle = subscription.handle,
                  incarnation = subscription.incarnation](const Result<ReadResponse>& response) {
            if (WatchedSubscription* found = subscriptions_.find(handle, incarnation)) {
                found->messages.is_republishing = false;
                if (!response && response.error() == status::Bad_Timeout) {
                    found->messages.republish_failures = 0;
                } else {
                    found->messages.has_sign = true;
                }
            }
            go_on(handle, incarnation);
        });
}

void Reception::stop_republishing(WatchedSubscription& subscription, bool is_sent)
{
    subscription.messages.republish_failures = 0;
    if (is_sent) {
        subscription.lose(status::Bad_MessageNotAvailable);
        subscription.messages.sequence.skip();
        deliver_kept(subscription.handle);
    } else {
        subscription.messages.is_probing = false; // there is nothing more
    }
}

void Reception::catch_up(WatchedSubscription& subscription)
{
    subscription.messages.catch_up(requests_.now());
    fetch_missing(subscription);
}

void Reception::probe_all()
{
    subscriptions_.for_each([this](WatchedSubscription& subscription) {
        subscription.messages.is_probing = subscription.phase == Phase::Live;
        fetch_missing(subscription);
    });
}

/// Part 4, 5.14.1.1: a message comes within each keep-alive interval. A server that answers
/// Republish and sends none for several intervals does not publish this Subscription any more. One
/// that answers neither may be at the end of a slow line, with the messages on their way, but not
/// for ever: then it is only other services that it answers.
void Reception::watch(WatchedSubscription& subscription, TimePoint now)
{
    if (subscription.phase != Phase::Live || now < subscription.messages.silent_at) {
        fetch_missing(subscription);
        return;
    }
    const bool is_server_alive = subscription.messages.is_server_alive;
    const std::uint32_t silences = subscription.messages.fall_silent(now);
    if ((silences >= max_silences && is_server_alive) ||
        (silences >= max_silences_of_others && subscription.messages.has_sign)) {
        ends_.lost(subscription, status::Bad_Timeout, true);
        requests_.call_for_work();
        return;
    }
    if (silences >= patient_silences) {
        publishes_.renew();
    }
    fetch_missing(subscription);
}

} // namespace busbar::client::detail
