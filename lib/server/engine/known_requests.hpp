#pragma once

#include <type_traits>

namespace busbar {

struct ActivateSessionRequest;
struct AddNodesRequest;
struct AddReferencesRequest;
struct BrowseNextRequest;
struct BrowseRequest;
struct CallRequest;
struct CancelRequest;
struct CloseSessionRequest;
struct CreateMonitoredItemsRequest;
struct CreateSessionRequest;
struct CreateSubscriptionRequest;
struct DeleteMonitoredItemsRequest;
struct DeleteNodesRequest;
struct DeleteReferencesRequest;
struct DeleteSubscriptionsRequest;
struct FindServersOnNetworkRequest;
struct FindServersRequest;
struct GetEndpointsRequest;
struct HistoryReadRequest;
struct HistoryUpdateRequest;
struct ModifyMonitoredItemsRequest;
struct ModifySubscriptionRequest;
struct PublishRequest;
struct QueryFirstRequest;
struct QueryNextRequest;
struct ReadRequest;
struct RegisterNodesRequest;
struct RegisterServer2Request;
struct RegisterServerRequest;
struct RepublishRequest;
struct SetMonitoringModeRequest;
struct SetPublishingModeRequest;
struct SetTriggeringRequest;
struct TransferSubscriptionsRequest;
struct TranslateBrowsePathsToNodeIdsRequest;
struct UnregisterNodesRequest;
struct WriteRequest;

namespace server::detail {

template <typename... T>
struct TypeList {
    template <typename Sought>
    static constexpr bool contains = (std::is_same_v<Sought, T> || ...);
};

/// Every request of Part 4, also those that are not supported.
using KnownRequests =
    TypeList<FindServersRequest, GetEndpointsRequest, RegisterServerRequest, RegisterServer2Request,
             FindServersOnNetworkRequest, CreateSessionRequest, ActivateSessionRequest,
             CloseSessionRequest, CancelRequest, AddNodesRequest, AddReferencesRequest,
             DeleteNodesRequest, DeleteReferencesRequest, BrowseRequest, BrowseNextRequest,
             TranslateBrowsePathsToNodeIdsRequest, RegisterNodesRequest, UnregisterNodesRequest,
             QueryFirstRequest, QueryNextRequest, ReadRequest, WriteRequest, HistoryReadRequest,
             HistoryUpdateRequest, CallRequest, CreateMonitoredItemsRequest,
             ModifyMonitoredItemsRequest, SetMonitoringModeRequest, SetTriggeringRequest,
             DeleteMonitoredItemsRequest, CreateSubscriptionRequest, ModifySubscriptionRequest,
             SetPublishingModeRequest, PublishRequest, RepublishRequest,
             TransferSubscriptionsRequest, DeleteSubscriptionsRequest>;

} // namespace server::detail

} // namespace busbar
