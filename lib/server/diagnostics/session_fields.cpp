#include "describe.hpp"

#include <array>
#include <type_traits>

namespace busbar::server::detail {

namespace {

/// Returns a structure as an ExtensionObject in a Variant.
template <typename T>
Variant to_variant(const T& value)
{
    if constexpr (std::is_constructible_v<Variant, const T&>) {
        return Variant{value};
    } else {
        return ExtensionObject::from(value);
    }
}

template <typename Structure>
struct Field {
    FieldName name;
    Variant (*get)(const Structure&);
};

template <auto Member, typename Structure>
constexpr Field<Structure> field(FieldName name)
{
    return {name, [](const Structure& from) { return to_variant(from.*Member); }};
}

template <typename Structure, std::size_t Count>
constexpr std::array<FieldName, Count> names_of(const std::array<Field<Structure>, Count>& fields)
{
    std::array<FieldName, Count> names{};
    for (std::size_t i = 0; i < Count; ++i) {
        names[i] = fields[i].name;
    }
    return names;
}

template <typename Structure, std::size_t Count>
Variant field_of(const Structure& from, const std::array<Field<Structure>, Count>& fields,
                 std::size_t field)
{
    if (field == 0 || field > Count) {
        Variant whole{ExtensionObject::from(from)};
        return whole;
    }
    return fields[field - 1].get(from);
}

using SessionData = SessionDiagnosticsDataType;

constexpr std::array session_fields{
    field<&SessionData::session_id, SessionData>("SessionId"),
    field<&SessionData::session_name, SessionData>("SessionName"),
    field<&SessionData::client_description, SessionData>("ClientDescription"),
    field<&SessionData::server_uri, SessionData>("ServerUri"),
    field<&SessionData::endpoint_url, SessionData>("EndpointUrl"),
    field<&SessionData::locale_ids, SessionData>("LocaleIds"),
    field<&SessionData::actual_session_timeout, SessionData>("ActualSessionTimeout"),
    field<&SessionData::max_response_message_size, SessionData>("MaxResponseMessageSize"),
    field<&SessionData::client_connection_time, SessionData>("ClientConnectionTime"),
    field<&SessionData::client_last_contact_time, SessionData>("ClientLastContactTime"),
    field<&SessionData::current_subscriptions_count, SessionData>("CurrentSubscriptionsCount"),
    field<&SessionData::current_monitored_items_count, SessionData>("CurrentMonitoredItemsCount"),
    field<&SessionData::current_publish_requests_in_queue, SessionData>(
        "CurrentPublishRequestsInQueue"),
    field<&SessionData::total_request_count, SessionData>("TotalRequestCount"),
    field<&SessionData::unauthorized_request_count, SessionData>("UnauthorizedRequestCount"),
    field<&SessionData::read_count, SessionData>("ReadCount"),
    field<&SessionData::history_read_count, SessionData>("HistoryReadCount"),
    field<&SessionData::write_count, SessionData>("WriteCount"),
    field<&SessionData::history_update_count, SessionData>("HistoryUpdateCount"),
    field<&SessionData::call_count, SessionData>("CallCount"),
    field<&SessionData::create_monitored_items_count, SessionData>("CreateMonitoredItemsCount"),
    field<&SessionData::modify_monitored_items_count, SessionData>("ModifyMonitoredItemsCount"),
    field<&SessionData::set_monitoring_mode_count, SessionData>("SetMonitoringModeCount"),
    field<&SessionData::set_triggering_count, SessionData>("SetTriggeringCount"),
    field<&SessionData::delete_monitored_items_count, SessionData>("DeleteMonitoredItemsCount"),
    field<&SessionData::create_subscription_count, SessionData>("CreateSubscriptionCount"),
    field<&SessionData::modify_subscription_count, SessionData>("ModifySubscriptionCount"),
    field<&SessionData::set_publishing_mode_count, SessionData>("SetPublishingModeCount"),
    field<&SessionData::publish_count, SessionData>("PublishCount"),
    field<&SessionData::republish_count, SessionData>("RepublishCount"),
    field<&SessionData::transfer_subscriptions_count, SessionData>("TransferSubscriptionsCount"),
    field<&SessionData::delete_subscriptions_count, SessionData>("DeleteSubscriptionsCount"),
    field<&SessionData::add_nodes_count, SessionData>("AddNodesCount"),
    field<&SessionData::add_references_count, SessionData>("AddReferencesCount"),
    field<&SessionData::delete_nodes_count, SessionData>("DeleteNodesCount"),
    field<&SessionData::delete_references_count, SessionData>("DeleteReferencesCount"),
    field<&SessionData::browse_count, SessionData>("BrowseCount"),
    field<&SessionData::browse_next_count, SessionData>("BrowseNextCount"),
    field<&SessionData::translate_browse_paths_to_node_ids_count, SessionData>(
        "TranslateBrowsePathsToNodeIdsCount"),
    field<&SessionData::query_first_count, SessionData>("QueryFirstCount"),
    field<&SessionData::query_next_count, SessionData>("QueryNextCount"),
    field<&SessionData::register_nodes_count, SessionData>("RegisterNodesCount"),
    field<&SessionData::unregister_nodes_count, SessionData>("UnregisterNodesCount"),
};

constexpr auto session_names = names_of(session_fields);

using SecurityData = SessionSecurityDiagnosticsDataType;

constexpr std::array security_fields{
    field<&SecurityData::session_id, SecurityData>("SessionId"),
    field<&SecurityData::client_user_id_of_session, SecurityData>("ClientUserIdOfSession"),
    field<&SecurityData::client_user_id_history, SecurityData>("ClientUserIdHistory"),
    field<&SecurityData::authentication_mechanism, SecurityData>("AuthenticationMechanism"),
    field<&SecurityData::encoding, SecurityData>("Encoding"),
    field<&SecurityData::transport_protocol, SecurityData>("TransportProtocol"),
    field<&SecurityData::security_mode, SecurityData>("SecurityMode"),
    field<&SecurityData::security_policy_uri, SecurityData>("SecurityPolicyUri"),
    field<&SecurityData::client_certificate, SecurityData>("ClientCertificate"),
};

constexpr auto security_names = names_of(security_fields);

using SubscriptionData = SubscriptionDiagnosticsDataType;

constexpr std::array subscription_fields{
    field<&SubscriptionData::session_id, SubscriptionData>("SessionId"),
    field<&SubscriptionData::subscription_id, SubscriptionData>("SubscriptionId"),
    field<&SubscriptionData::priority, SubscriptionData>("Priority"),
    field<&SubscriptionData::publishing_interval, SubscriptionData>("PublishingInterval"),
    field<&SubscriptionData::max_keep_alive_count, SubscriptionData>("MaxKeepAliveCount"),
    field<&SubscriptionData::max_lifetime_count, SubscriptionData>("MaxLifetimeCount"),
    field<&SubscriptionData::max_notifications_per_publish, SubscriptionData>(
        "MaxNotificationsPerPublish"),
    field<&SubscriptionData::publishing_enabled, SubscriptionData>("PublishingEnabled"),
    field<&SubscriptionData::modify_count, SubscriptionData>("ModifyCount"),
    field<&SubscriptionData::enable_count, SubscriptionData>("EnableCount"),
    field<&SubscriptionData::disable_count, SubscriptionData>("DisableCount"),
    field<&SubscriptionData::republish_request_count, SubscriptionData>("RepublishRequestCount"),
    field<&SubscriptionData::republish_message_request_count, SubscriptionData>(
        "RepublishMessageRequestCount"),
    field<&SubscriptionData::republish_message_count, SubscriptionData>("RepublishMessageCount"),
    field<&SubscriptionData::transfer_request_count, SubscriptionData>("TransferRequestCount"),
    field<&SubscriptionData::transferred_to_alt_client_count, SubscriptionData>(
        "TransferredToAltClientCount"),
    field<&SubscriptionData::transferred_to_same_client_count, SubscriptionData>(
        "TransferredToSameClientCount"),
    field<&SubscriptionData::publish_request_count, SubscriptionData>("PublishRequestCount"),
    field<&SubscriptionData::data_change_notifications_count, SubscriptionData>(
        "DataChangeNotificationsCount"),
    field<&SubscriptionData::event_notifications_count, SubscriptionData>(
        "EventNotificationsCount"),
    field<&SubscriptionData::notifications_count, SubscriptionData>("NotificationsCount"),
    field<&SubscriptionData::late_publish_request_count, SubscriptionData>(
        "LatePublishRequestCount"),
    field<&SubscriptionData::current_keep_alive_count, SubscriptionData>("CurrentKeepAliveCount"),
    field<&SubscriptionData::current_lifetime_count, SubscriptionData>("CurrentLifetimeCount"),
    field<&SubscriptionData::unacknowledged_message_count, SubscriptionData>(
        "UnacknowledgedMessageCount"),
    field<&SubscriptionData::discarded_message_count, SubscriptionData>("DiscardedMessageCount"),
    field<&SubscriptionData::monitored_item_count, SubscriptionData>("MonitoredItemCount"),
    field<&SubscriptionData::disabled_monitored_item_count, SubscriptionData>(
        "DisabledMonitoredItemCount"),
    field<&SubscriptionData::monitoring_queue_overflow_count, SubscriptionData>(
        "MonitoringQueueOverflowCount"),
    field<&SubscriptionData::next_sequence_number, SubscriptionData>("NextSequenceNumber"),
    field<&SubscriptionData::event_queue_overflow_count, SubscriptionData>(
        "EventQueueOverflowCount"),
};

constexpr auto subscription_names = names_of(subscription_fields);

} // namespace

std::span<const FieldName> session_field_names()
{
    return session_names;
}

Variant session_field(const SessionDiagnosticsDataType& session, std::size_t field)
{
    return field_of(session, session_fields, field);
}

std::span<const FieldName> security_field_names()
{
    return security_names;
}

Variant security_field(const SessionSecurityDiagnosticsDataType& session, std::size_t field)
{
    return field_of(session, security_fields, field);
}

std::span<const FieldName> subscription_field_names()
{
    return subscription_names;
}

Variant subscription_field(const SubscriptionDiagnosticsDataType& subscription, std::size_t field)
{
    return field_of(subscription, subscription_fields, field);
}

} // namespace busbar::server::detail
