#include "session_fields.hpp"

#include <array>
#include <type_traits>

namespace busbar::server::detail {

namespace {

/// A structure goes into a Variant as an ExtensionObject.
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
    return field == 0 || field > Count ? Variant{ExtensionObject::from(from)}
                                       : fields[field - 1].get(from);
}

using Session = SessionDiagnosticsDataType;

constexpr std::array session_fields{
    field<&Session::session_id, Session>("SessionId"),
    field<&Session::session_name, Session>("SessionName"),
    field<&Session::client_description, Session>("ClientDescription"),
    field<&Session::server_uri, Session>("ServerUri"),
    field<&Session::endpoint_url, Session>("EndpointUrl"),
    field<&Session::locale_ids, Session>("LocaleIds"),
    field<&Session::actual_session_timeout, Session>("ActualSessionTimeout"),
    field<&Session::max_response_message_size, Session>("MaxResponseMessageSize"),
    field<&Session::client_connection_time, Session>("ClientConnectionTime"),
    field<&Session::client_last_contact_time, Session>("ClientLastContactTime"),
    field<&Session::current_subscriptions_count, Session>("CurrentSubscriptionsCount"),
    field<&Session::current_monitored_items_count, Session>("CurrentMonitoredItemsCount"),
    field<&Session::current_publish_requests_in_queue, Session>("CurrentPublishRequestsInQueue"),
    field<&Session::total_request_count, Session>("TotalRequestCount"),
    field<&Session::unauthorized_request_count, Session>("UnauthorizedRequestCount"),
    field<&Session::read_count, Session>("ReadCount"),
    field<&Session::history_read_count, Session>("HistoryReadCount"),
    field<&Session::write_count, Session>("WriteCount"),
    field<&Session::history_update_count, Session>("HistoryUpdateCount"),
    field<&Session::call_count, Session>("CallCount"),
    field<&Session::create_monitored_items_count, Session>("CreateMonitoredItemsCount"),
    field<&Session::modify_monitored_items_count, Session>("ModifyMonitoredItemsCount"),
    field<&Session::set_monitoring_mode_count, Session>("SetMonitoringModeCount"),
    field<&Session::set_triggering_count, Session>("SetTriggeringCount"),
    field<&Session::delete_monitored_items_count, Session>("DeleteMonitoredItemsCount"),
    field<&Session::create_subscription_count, Session>("CreateSubscriptionCount"),
    field<&Session::modify_subscription_count, Session>("ModifySubscriptionCount"),
    field<&Session::set_publishing_mode_count, Session>("SetPublishingModeCount"),
    field<&Session::publish_count, Session>("PublishCount"),
    field<&Session::republish_count, Session>("RepublishCount"),
    field<&Session::transfer_subscriptions_count, Session>("TransferSubscriptionsCount"),
    field<&Session::delete_subscriptions_count, Session>("DeleteSubscriptionsCount"),
    field<&Session::add_nodes_count, Session>("AddNodesCount"),
    field<&Session::add_references_count, Session>("AddReferencesCount"),
    field<&Session::delete_nodes_count, Session>("DeleteNodesCount"),
    field<&Session::delete_references_count, Session>("DeleteReferencesCount"),
    field<&Session::browse_count, Session>("BrowseCount"),
    field<&Session::browse_next_count, Session>("BrowseNextCount"),
    field<&Session::translate_browse_paths_to_node_ids_count, Session>(
        "TranslateBrowsePathsToNodeIdsCount"),
    field<&Session::query_first_count, Session>("QueryFirstCount"),
    field<&Session::query_next_count, Session>("QueryNextCount"),
    field<&Session::register_nodes_count, Session>("RegisterNodesCount"),
    field<&Session::unregister_nodes_count, Session>("UnregisterNodesCount"),
};

constexpr auto session_names = names_of(session_fields);

using Security = SessionSecurityDiagnosticsDataType;

constexpr std::array security_fields{
    field<&Security::session_id, Security>("SessionId"),
    field<&Security::client_user_id_of_session, Security>("ClientUserIdOfSession"),
    field<&Security::client_user_id_history, Security>("ClientUserIdHistory"),
    field<&Security::authentication_mechanism, Security>("AuthenticationMechanism"),
    field<&Security::encoding, Security>("Encoding"),
    field<&Security::transport_protocol, Security>("TransportProtocol"),
    field<&Security::security_mode, Security>("SecurityMode"),
    field<&Security::security_policy_uri, Security>("SecurityPolicyUri"),
    field<&Security::client_certificate, Security>("ClientCertificate"),
};

constexpr auto security_names = names_of(security_fields);

} // namespace

std::span<const FieldName> session_field_names()
{
    return session_names;
}

Variant session_field(const Session& session, std::size_t field)
{
    return field_of(session, session_fields, field);
}

std::span<const FieldName> security_field_names()
{
    return security_names;
}

Variant security_field(const Security& session, std::size_t field)
{
    return field_of(session, security_fields, field);
}

} // namespace busbar::server::detail
