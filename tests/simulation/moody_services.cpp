#include <algorithm>
#include <utility>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/ids.hpp>

#include "moody_server.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

Result<MoodyServer::Session*> MoodyServer::session_of(const RequestHeader& header)
{
    const NodeId& token = header.authentication_token;
    const auto found = token.is_numeric() ? sessions_.find(token.numeric()) : sessions_.end();
    if (found == sessions_.end() || !found->second.is_active) {
        return fail(status::Bad_SessionIdInvalid);
    }
    return &found->second;
}

Result<FindServersResponse> MoodyServer::find_servers(const FindServersRequest& request)
{
    FindServersResponse response;
    ApplicationDescription& self = response.servers.emplace_back();
    self.application_uri = "urn:busbar:test:moody";
    self.discovery_urls.push_back(request.endpoint_url);
    return response;
}

Result<RegisterServerResponse>
MoodyServer::register_server(const RegisterServerRequest& /*request*/)
{
    return RegisterServerResponse{};
}

Result<RegisterServer2Response> MoodyServer::register_server2(const RegisterServer2Request& request)
{
    RegisterServer2Response response;
    response.configuration_results = Array<StatusCode>(request.discovery_configuration.size());
    return response;
}

Result<GetEndpointsResponse> MoodyServer::get_endpoints(const GetEndpointsRequest& request)
{
    GetEndpointsResponse response;
    EndpointDescription& endpoint = response.endpoints.emplace_back();
    endpoint.endpoint_url = request.endpoint_url;
    endpoint.server.application_uri = "urn:busbar:test:moody";
    endpoint.security_mode = MessageSecurityMode::None;
    endpoint.security_policy_uri = String{crypto::policy_none().uri};
    endpoint.transport_profile_uri =
        "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
    UserTokenPolicy& policy = endpoint.user_identity_tokens.emplace_back();
    policy.policy_id = "anonymous";
    policy.token_type = UserTokenType::Anonymous;
    return response;
}

Result<CreateSessionResponse> MoodyServer::create_session(const CreateSessionRequest& request)
{
    GetEndpointsRequest endpoints;
    endpoints.endpoint_url = request.endpoint_url;
    CreateSessionResponse response;
    response.session_id = NodeId{1, ++last_id_};
    response.authentication_token = NodeId{1, ++last_id_};
    response.revised_session_timeout = request.requested_session_timeout;
    response.server_nonce = ByteString{std::vector<std::byte>(32, std::byte(last_id_))};
    response.server_endpoints = get_endpoints(endpoints)->endpoints;
    sessions_[last_id_] = Session{};
    return response;
}

Result<ActivateSessionResponse> MoodyServer::activate_session(const ActivateSessionRequest& request)
{
    const NodeId& token = request.request_header.authentication_token;
    const auto found = token.is_numeric() ? sessions_.find(token.numeric()) : sessions_.end();
    if (found == sessions_.end()) {
        return fail(status::Bad_SessionIdInvalid);
    }
    found->second.is_active = true;
    ActivateSessionResponse response;
    response.server_nonce = ByteString{std::vector<std::byte>(32, std::byte(++last_id_))};
    return response;
}

Result<CloseSessionResponse> MoodyServer::close_session(const CloseSessionRequest& request)
{
    const std::uint32_t token = request.request_header.authentication_token.numeric();
    if (request.delete_subscriptions) {
        std::erase_if(subscriptions_,
                      [&](const auto& entry) { return entry.second.session == token; });
    }
    sessions_.erase(token);
    return CloseSessionResponse{};
}

Result<ReadResponse> MoodyServer::read(const ReadRequest& request)
{
    if (const auto session = session_of(request.request_header); !session) {
        return fail(session.error());
    }
    ReadResponse response;
    for (const ReadValueId& item : request.nodes_to_read) {
        DataValue& result = response.results.emplace_back();
        if (item.node_id.namespace_index() != 0) {
            result.value = Variant{value()};
        } else if (item.node_id.is(id::Server_ServerStatus_State)) {
            result.value = Variant{std::int32_t{0}};
        } else if (item.node_id.is(id::Server_NamespaceArray)) {
            result.value =
                Variant{Array<String>{String{"http://opcfoundation.org/UA/"}, String{"urn:x"}}};
        } else {
            result = DataValue{status::Bad_NodeIdUnknown};
        }
    }
    return response;
}

Result<WriteResponse> MoodyServer::write(const WriteRequest& request)
{
    WriteResponse response;
    response.results = Array<StatusCode>(request.nodes_to_write.size());
    return response;
}

Result<CallResponse> MoodyServer::call(const CallRequest& request)
{
    CallResponse response;
    for (const CallMethodRequest& each : request.methods_to_call) {
        const bool is_mine = each.object_id.namespace_index() != 0;
        response.results.emplace_back().status_code =
            is_mine ? StatusCode{} : StatusCode{status::Bad_MethodInvalid};
    }
    return response;
}

namespace {

/// Each node has two more, down to the fifth level.
BrowseResult references_of(const NodeId& node)
{
    BrowseResult result;
    const std::uint32_t number = node.namespace_index() == 1 ? node.numeric() : 1;
    for (std::uint32_t i = 0; number < 32 && i < 2; ++i) {
        ReferenceDescription& reference = result.references.emplace_back();
        reference.reference_type_id = NodeId{0, id::Organizes};
        reference.is_forward = true;
        reference.node_id = ExpandedNodeId{NodeId{1, 2 * number + i}};
        reference.node_class = NodeClass::Object;
    }
    return result;
}

} // namespace

Result<BrowseResponse> MoodyServer::browse(const BrowseRequest& request)
{
    BrowseResponse response;
    for (const BrowseDescription& each : request.nodes_to_browse) {
        response.results.push_back(references_of(each.node_id));
    }
    return response;
}

Result<BrowseNextResponse> MoodyServer::browse_next(const BrowseNextRequest& request)
{
    BrowseNextResponse response;
    for (std::size_t i = 0; i < request.continuation_points.size(); ++i) {
        response.results.push_back(references_of(NodeId{1, 1U}));
    }
    return response;
}

Result<TranslateBrowsePathsToNodeIdsResponse>
MoodyServer::translate(const TranslateBrowsePathsToNodeIdsRequest& request)
{
    TranslateBrowsePathsToNodeIdsResponse response;
    for (std::size_t i = 0; i < request.browse_paths.size(); ++i) {
        BrowsePathTarget& target = response.results.emplace_back().targets.emplace_back();
        target.target_id = ExpandedNodeId{NodeId{1, 1U}};
        target.remaining_path_index = 0xFFFF'FFFF;
    }
    return response;
}

Result<RegisterNodesResponse> MoodyServer::register_nodes(const RegisterNodesRequest& request)
{
    RegisterNodesResponse response;
    response.registered_node_ids = request.nodes_to_register;
    return response;
}

Result<UnregisterNodesResponse>
MoodyServer::unregister_nodes(const UnregisterNodesRequest& /*request*/)
{
    return UnregisterNodesResponse{};
}

Result<CreateSubscriptionResponse> MoodyServer::create(const CreateSubscriptionRequest& request)
{
    if (const auto session = session_of(request.request_header); !session) {
        return fail(session.error());
    }
    CreateSubscriptionResponse response;
    response.subscription_id = ++last_id_;
    response.revised_publishing_interval =
        std::clamp(request.requested_publishing_interval, 1'000.0, 60'000.0);
    response.revised_max_keep_alive_count =
        std::clamp<std::uint32_t>(request.requested_max_keep_alive_count, 1, 10);
    response.revised_lifetime_count = 3 * response.revised_max_keep_alive_count;
    Subscription& made = subscriptions_[last_id_];
    made.session = request.request_header.authentication_token.numeric();
    made.interval = std::chrono::duration_cast<Duration>(
        std::chrono::duration<double, std::milli>{response.revised_publishing_interval});
    made.keep_alive_count = response.revised_max_keep_alive_count;
    made.lifetime_count = response.revised_lifetime_count;
    made.alarm =
        std::make_unique<Alarm>(world_.scheduler(), [this, number = last_id_] { be_due(number); });
    made.alarm->set_after(made.interval);
    return response;
}

Result<ModifySubscriptionResponse> MoodyServer::modify(const ModifySubscriptionRequest& request)
{
    const auto found = subscriptions_.find(request.subscription_id);
    if (found == subscriptions_.end()) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    const double interval = std::clamp(request.requested_publishing_interval, 1'000.0, 60'000.0);
    found->second.interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>{interval});
    ModifySubscriptionResponse response;
    response.revised_publishing_interval =
        std::chrono::duration<double, std::milli>{found->second.interval}.count();
    response.revised_max_keep_alive_count = found->second.keep_alive_count;
    response.revised_lifetime_count = found->second.lifetime_count;
    return response;
}

Result<DeleteSubscriptionsResponse> MoodyServer::remove(const DeleteSubscriptionsRequest& request)
{
    DeleteSubscriptionsResponse response;
    for (const std::uint32_t each : request.subscription_ids) {
        const bool was_there = subscriptions_.erase(each) != 0;
        response.results.push_back(was_there ? StatusCode{}
                                             : StatusCode{status::Bad_SubscriptionIdInvalid});
    }
    return response;
}

Result<SetPublishingModeResponse> MoodyServer::set_mode(const SetPublishingModeRequest& request)
{
    SetPublishingModeResponse response;
    for (const std::uint32_t each : request.subscription_ids) {
        response.results.push_back(subscriptions_.contains(each)
                                       ? StatusCode{}
                                       : StatusCode{status::Bad_SubscriptionIdInvalid});
    }
    return response;
}

Result<TransferSubscriptionsResponse>
MoodyServer::transfer(const TransferSubscriptionsRequest& request)
{
    if (const auto session = session_of(request.request_header); !session) {
        return fail(session.error());
    }
    TransferSubscriptionsResponse response;
    for (const std::uint32_t each : request.subscription_ids) {
        const auto found = subscriptions_.find(each);
        TransferResult& result = response.results.emplace_back();
        if (found == subscriptions_.end()) {
            result.status_code = status::Bad_SubscriptionIdInvalid;
        } else {
            found->second.session = request.request_header.authentication_token.numeric();
            found->second.last_value = -1;
        }
    }
    return response;
}

Result<RepublishResponse> MoodyServer::republish(const RepublishRequest& request)
{
    const auto found = subscriptions_.find(request.subscription_id);
    if (found == subscriptions_.end()) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    if (ailment_of(RepublishRequest::binary_encoding_id).mood != Mood::Endless) {
        return fail(status::Bad_MessageNotAvailable);
    }
    RepublishResponse response;
    response.notification_message.sequence_number = request.retransmit_sequence_number;
    response.notification_message.publish_time = world_.clock().now();
    return response;
}

Result<CreateMonitoredItemsResponse>
MoodyServer::create_items(const CreateMonitoredItemsRequest& request)
{
    const auto found = subscriptions_.find(request.subscription_id);
    if (found == subscriptions_.end()) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    CreateMonitoredItemsResponse response;
    Subscription& subscription = found->second;
    const bool refuses =
        ailment_of(CreateMonitoredItemsRequest::binary_encoding_id).mood == Mood::RefusesResults;
    for (const MonitoredItemCreateRequest& each : request.items_to_create) {
        MonitoredItemCreateResult& result = response.results.emplace_back();
        result.monitored_item_id = ++subscription.last_item;
        result.revised_sampling_interval = 1'000;
        result.revised_queue_size = 1;
        if (!refuses) {
            subscription.items[subscription.last_item] = each.requested_parameters.client_handle;
        }
    }
    subscription.last_value = -1; // the first notification
    return response;
}

Result<ModifyMonitoredItemsResponse>
MoodyServer::modify_items(const ModifyMonitoredItemsRequest& request)
{
    const auto found = subscriptions_.find(request.subscription_id);
    if (found == subscriptions_.end()) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    ModifyMonitoredItemsResponse response;
    for (const MonitoredItemModifyRequest& each : request.items_to_modify) {
        MonitoredItemModifyResult& result = response.results.emplace_back();
        result.revised_sampling_interval = 1'000;
        result.revised_queue_size = 1;
        const auto item = found->second.items.find(each.monitored_item_id);
        if (item == found->second.items.end()) {
            result.status_code = status::Bad_MonitoredItemIdInvalid;
        } else {
            item->second = each.requested_parameters.client_handle;
        }
    }
    return response;
}

Result<SetMonitoringModeResponse>
MoodyServer::set_monitoring(const SetMonitoringModeRequest& request)
{
    if (!subscriptions_.contains(request.subscription_id)) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    SetMonitoringModeResponse response;
    response.results = Array<StatusCode>(request.monitored_item_ids.size());
    return response;
}

Result<SetTriggeringResponse> MoodyServer::set_triggering(const SetTriggeringRequest& request)
{
    if (!subscriptions_.contains(request.subscription_id)) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    SetTriggeringResponse response;
    response.add_results = Array<StatusCode>(request.links_to_add.size());
    response.remove_results = Array<StatusCode>(request.links_to_remove.size());
    return response;
}

Result<DeleteMonitoredItemsResponse>
MoodyServer::delete_items(const DeleteMonitoredItemsRequest& request)
{
    const auto found = subscriptions_.find(request.subscription_id);
    if (found == subscriptions_.end()) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    DeleteMonitoredItemsResponse response;
    for (const std::uint32_t each : request.monitored_item_ids) {
        const bool was_there = found->second.items.erase(each) != 0;
        response.results.push_back(was_there ? StatusCode{}
                                             : StatusCode{status::Bad_MonitoredItemIdInvalid});
    }
    return response;
}

} // namespace busbar::test
