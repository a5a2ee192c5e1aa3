#include "describe.hpp"

#include "server/session/counters.hpp"
#include "server/session/session.hpp"
#include "server/subscription/publish_queue.hpp"
#include "server/subscription/subscription.hpp"

namespace busbar::server::detail {

namespace {

String mechanism_of(UserTokenType type)
{
    switch (type) {
    case UserTokenType::UserName:
        return "UserName";
    case UserTokenType::Certificate:
        return "Certificate";
    case UserTokenType::IssuedToken:
        return "IssuedToken";
    default:
        return "Anonymous";
    }
}

} // namespace

/// Part 5, 12.11.
SessionDiagnosticsDataType describe_session(const Counters& counters, const Session& session)
{
    SessionDiagnosticsDataType result = counters.values(session);
    result.session_id = session.id;
    result.session_name = session.name;
    result.client_description = session.client_description;
    result.server_uri = session.server_uri;
    result.endpoint_url = session.endpoint_url;
    result.locale_ids = Array<String>(0);
    for (const std::string& locale : session.locale_ids) {
        result.locale_ids.emplace_back(locale);
    }
    result.actual_session_timeout = static_cast<double>(session.timeout.count());
    result.max_response_message_size = session.max_response_message_size;
    result.client_connection_time = session.connection_time;
    if (const PublishPart* const part = PublishPart::find(session)) {
        result.current_subscriptions_count = count(part->subscriptions().size());
        result.current_publish_requests_in_queue = count(part->waiting());
        for (const Subscription* subscription : part->subscriptions()) {
            result.current_monitored_items_count += count(subscription->item_count());
        }
    }
    return result;
}

/// Part 5, 12.12.
SessionSecurityDiagnosticsDataType describe_security(const Session& session)
{
    SessionSecurityDiagnosticsDataType result;
    result.session_id = session.id;
    result.client_user_id_of_session =
        session.users.empty() ? std::string{} : session.users.front();
    result.client_user_id_history = Array<String>(0);
    for (const std::string& user : session.users) {
        result.client_user_id_history.emplace_back(user);
    }
    result.authentication_mechanism = mechanism_of(session.user.token_type);
    result.encoding = "UA Binary";
    result.transport_protocol = "opc.tcp";
    result.security_mode = session.security.mode;
    result.security_policy_uri = String{session.security.policy->uri};
    if (!session.client_certificate.empty()) {
        result.client_certificate = ByteString{session.client_certificate.front().der()};
    }
    return result;
}

/// Part 5, 12.15.
SubscriptionDiagnosticsDataType describe_subscription(const Counters& counters,
                                                      const Subscription& subscription)
{
    const SubscriptionParameters& parameters = subscription.parameters();
    SubscriptionDiagnosticsDataType result = counters.values(subscription.counters());
    result.session_id = subscription.session() != nullptr ? subscription.session()->id : NodeId{};
    result.subscription_id = subscription.id();
    result.priority = parameters.priority;
    result.publishing_interval = to_milliseconds(parameters.publishing_interval);
    result.max_keep_alive_count = parameters.max_keep_alive_count;
    result.max_lifetime_count = parameters.lifetime_count;
    result.max_notifications_per_publish = parameters.max_notifications_per_publish;
    result.publishing_enabled = subscription.publishing_enabled();
    result.monitored_item_count = count(subscription.item_count());
    result.disabled_monitored_item_count = count(subscription.disabled_item_count());
    result.next_sequence_number = subscription.next_sequence_number();
    result.unacknowledged_message_count = count(subscription.retransmission().size());
    result.current_lifetime_count = subscription.lifetime_counter();
    // One Republish asks for one message.
    result.republish_message_request_count = result.republish_request_count;
    result.notifications_count =
        result.data_change_notifications_count + result.event_notifications_count;
    return result;
}

Variant describe_subscriptions(const Counters& counters, const Session& session)
{
    Array<ExtensionObject> all(0);
    if (const PublishPart* const part = PublishPart::find(session)) {
        for (const Subscription* subscription : part->subscriptions()) {
            all.push_back(ExtensionObject::from(describe_subscription(counters, *subscription)));
        }
    }
    return all;
}

} // namespace busbar::server::detail
