#include "service_table.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/discovery.hpp>
#include <busbar/types/history.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/query.hpp>
#include <busbar/types/secure_channel.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "known_requests.hpp"

namespace busbar::server::detail {

namespace {

template <typename... T>
constexpr auto sorted_ids(TypeList<T...> /*types*/)
{
    std::array ids{T::binary_encoding_id...};
    std::sort(ids.begin(), ids.end());
    return ids;
}

constexpr auto requests = sorted_ids(KnownRequests{});

constexpr auto responses = sorted_ids(
    TypeList<ServiceFault, OpenSecureChannelResponse, CloseSecureChannelResponse,
             FindServersResponse, GetEndpointsResponse, RegisterServerResponse,
             RegisterServer2Response, FindServersOnNetworkResponse, CreateSessionResponse,
             ActivateSessionResponse, CloseSessionResponse, CancelResponse, AddNodesResponse,
             AddReferencesResponse, DeleteNodesResponse, DeleteReferencesResponse, BrowseResponse,
             BrowseNextResponse, TranslateBrowsePathsToNodeIdsResponse, RegisterNodesResponse,
             UnregisterNodesResponse, QueryFirstResponse, QueryNextResponse, ReadResponse,
             WriteResponse, HistoryReadResponse, HistoryUpdateResponse, CallResponse,
             CreateMonitoredItemsResponse, ModifyMonitoredItemsResponse, SetMonitoringModeResponse,
             SetTriggeringResponse, DeleteMonitoredItemsResponse, CreateSubscriptionResponse,
             ModifySubscriptionResponse, SetPublishingModeResponse, PublishResponse,
             RepublishResponse, TransferSubscriptionsResponse, DeleteSubscriptionsResponse>{});

/// Returns the place of the service, or the place where it must be inserted.
template <typename Services>
auto place_of(Services& services, std::uint32_t encoding_id)
{
    return std::lower_bound(
        services.begin(), services.end(), encoding_id,
        [](const Service& service, std::uint32_t id) { return service.encoding_id < id; });
}

bool is_number(const NodeId& id)
{
    return id.namespace_index() == 0 && id.is_numeric();
}

} // namespace

ServiceTable::ServiceTable()
{
    services_.reserve(requests.size());
    for (const std::uint32_t id : requests) {
        services_.push_back({id, Need::Nothing, Lasts::ToTheEnd, nullptr});
    }
}

void ServiceTable::add(std::span<const Service> services)
{
    for (const Service& service : services) {
        const auto place = place_of(services_, service.encoding_id);
        if (place != services_.end() && place->encoding_id == service.encoding_id) {
            *place = service;
        } else {
            services_.insert(place, service);
        }
    }
}

const Service* ServiceTable::find(const NodeId& encoding_id) const
{
    if (!is_number(encoding_id)) {
        return nullptr;
    }
    const auto place = place_of(services_, encoding_id.numeric());
    return place != services_.end() && place->encoding_id == encoding_id.numeric() ? &*place
                                                                                   : nullptr;
}

bool is_response(const NodeId& encoding_id)
{
    return is_number(encoding_id) &&
           std::binary_search(responses.begin(), responses.end(), encoding_id.numeric());
}

} // namespace busbar::server::detail
