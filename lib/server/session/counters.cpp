#include "counters.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "session.hpp"

namespace busbar::server::detail {

namespace {

using OfSession = SessionDiagnosticsDataType;

struct ServiceCounter {
    std::uint32_t encoding_id;
    ServiceCounterDataType OfSession::*counter;
};

/// The counters of Part 5, 12.11 for the supported services.
constexpr auto service_counters = [] {
    std::array table{
        ServiceCounter{ReadRequest::binary_encoding_id, &OfSession::read_count},
        ServiceCounter{WriteRequest::binary_encoding_id, &OfSession::write_count},
        ServiceCounter{CallRequest::binary_encoding_id, &OfSession::call_count},
        ServiceCounter{CreateMonitoredItemsRequest::binary_encoding_id,
                       &OfSession::create_monitored_items_count},
        ServiceCounter{ModifyMonitoredItemsRequest::binary_encoding_id,
                       &OfSession::modify_monitored_items_count},
        ServiceCounter{SetMonitoringModeRequest::binary_encoding_id,
                       &OfSession::set_monitoring_mode_count},
        ServiceCounter{SetTriggeringRequest::binary_encoding_id, &OfSession::set_triggering_count},
        ServiceCounter{DeleteMonitoredItemsRequest::binary_encoding_id,
                       &OfSession::delete_monitored_items_count},
        ServiceCounter{CreateSubscriptionRequest::binary_encoding_id,
                       &OfSession::create_subscription_count},
        ServiceCounter{ModifySubscriptionRequest::binary_encoding_id,
                       &OfSession::modify_subscription_count},
        ServiceCounter{SetPublishingModeRequest::binary_encoding_id,
                       &OfSession::set_publishing_mode_count},
        ServiceCounter{PublishRequest::binary_encoding_id, &OfSession::publish_count},
        ServiceCounter{RepublishRequest::binary_encoding_id, &OfSession::republish_count},
        ServiceCounter{TransferSubscriptionsRequest::binary_encoding_id,
                       &OfSession::transfer_subscriptions_count},
        ServiceCounter{DeleteSubscriptionsRequest::binary_encoding_id,
                       &OfSession::delete_subscriptions_count},
        ServiceCounter{AddNodesRequest::binary_encoding_id, &OfSession::add_nodes_count},
        ServiceCounter{AddReferencesRequest::binary_encoding_id, &OfSession::add_references_count},
        ServiceCounter{DeleteNodesRequest::binary_encoding_id, &OfSession::delete_nodes_count},
        ServiceCounter{DeleteReferencesRequest::binary_encoding_id,
                       &OfSession::delete_references_count},
        ServiceCounter{BrowseRequest::binary_encoding_id, &OfSession::browse_count},
        ServiceCounter{BrowseNextRequest::binary_encoding_id, &OfSession::browse_next_count},
        ServiceCounter{TranslateBrowsePathsToNodeIdsRequest::binary_encoding_id,
                       &OfSession::translate_browse_paths_to_node_ids_count},
        ServiceCounter{RegisterNodesRequest::binary_encoding_id, &OfSession::register_nodes_count},
        ServiceCounter{UnregisterNodesRequest::binary_encoding_id,
                       &OfSession::unregister_nodes_count},
    };
    std::sort(table.begin(), table.end(), [](const ServiceCounter& a, const ServiceCounter& b) {
        return a.encoding_id < b.encoding_id;
    });
    return table;
}();

/// Returns null for a service that has no counter of its own.
ServiceCounterDataType* find_counter(OfSession& counters, std::uint32_t encoding_id)
{
    const auto* const found = std::lower_bound(
        service_counters.begin(), service_counters.end(), encoding_id,
        [](const ServiceCounter& counter, std::uint32_t id) { return counter.encoding_id < id; });
    return found != service_counters.end() && found->encoding_id == encoding_id
               ? &(counters.*found->counter)
               : nullptr;
}

bool is_security(StatusCode status)
{
    constexpr std::array codes{
        status::Bad_UserAccessDenied,       status::Bad_SecurityChecksFailed,
        status::Bad_IdentityTokenInvalid,   status::Bad_IdentityTokenRejected,
        status::Bad_UserSignatureInvalid,   status::Bad_ApplicationSignatureInvalid,
        status::Bad_SecureChannelIdInvalid, status::Bad_SessionIdInvalid,
        status::Bad_SessionNotActivated,    status::Bad_SecurityPolicyRejected,
        status::Bad_CertificateUriInvalid,  status::Bad_CertificateInvalid,
        status::Bad_SecurityModeRejected,   status::Bad_SecurityModeInsufficient,
        status::Bad_NonceInvalid,
    };
    return std::find(codes.begin(), codes.end(), status.code()) != codes.end();
}

} // namespace

void Counters::take_flag(const model::AddressSpace& space, const Present& present)
{
    const model::NodeIndex flag = space.find(id::Server_ServerDiagnostics_EnabledFlag);
    const bool is_set = flag != model::no_node && space.value(flag).value_or(false);
    if (is_set && !is_enabled_) {
        summary = {};
        summary.cumulated_session_count = static_cast<std::uint32_t>(present.sessions);
        summary.cumulated_subscription_count = static_cast<std::uint32_t>(present.subscriptions);
        ++round_;
    }
    is_enabled_ = is_set;
}

SessionDiagnosticsDataType& Counters::counters(Session& session) const
{
    if (session.diagnostics_round != round_) {
        session.diagnostics_round = round_;
        session.diagnostics = {};
    }
    return session.diagnostics;
}

SessionDiagnosticsDataType Counters::values(const Session& session) const
{
    return session.diagnostics_round == round_ ? session.diagnostics : SessionDiagnosticsDataType{};
}

void Counters::count_request(Session& session, std::uint32_t encoding_id, DateTime now)
{
    if (!is_enabled_) {
        return;
    }
    OfSession& all = counters(session);
    all.client_last_contact_time = now;
    ++all.total_request_count.total_count;
    if (ServiceCounterDataType* const counter = find_counter(all, encoding_id)) {
        ++counter->total_count;
    }
}

void Counters::count_fault(Session* session, std::uint32_t encoding_id, StatusCode status)
{
    if (!is_enabled_) {
        return;
    }
    const bool is_for_session = encoding_id == CreateSessionRequest::binary_encoding_id ||
                                encoding_id == ActivateSessionRequest::binary_encoding_id;
    const std::uint32_t by_security = is_security(status) ? 1 : 0;
    ++summary.rejected_requests_count;
    summary.security_rejected_requests_count += by_security;
    summary.rejected_session_count += is_for_session ? 1U : 0U;
    summary.security_rejected_session_count += is_for_session ? by_security : 0;
    if (session == nullptr) {
        return;
    }
    OfSession& all = counters(*session);
    ++all.total_request_count.error_count;
    all.unauthorized_request_count += status == status::Bad_UserAccessDenied ? 1U : 0U;
    if (ServiceCounterDataType* const counter = find_counter(all, encoding_id)) {
        ++counter->error_count;
    }
}

} // namespace busbar::server::detail
