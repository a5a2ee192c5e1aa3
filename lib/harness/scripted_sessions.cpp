#include <algorithm>
#include <utility>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "session_proof.hpp"

namespace busbar::harness {

namespace {

constexpr std::uint32_t value_attribute = 13;
UserTokenPolicy token_policy(const char* id, UserTokenType type)
{
    UserTokenPolicy policy;
    policy.policy_id = id;
    policy.token_type = type;
    return policy;
}

} // namespace

std::function<bool(const ReadRequest&)> reads(const NodeId& node)
{
    return [node](const ReadRequest& request) {
        const auto& items = request.nodes_to_read;
        return std::any_of(items.begin(), items.end(), [&](const ReadValueId& item) {
            return item.node_id == node && item.attribute_id == value_attribute;
        });
    };
}

std::vector<EndpointDescription> ScriptedServer::endpoints(const String& url) const
{
    std::vector<EndpointDescription> endpoints;
    for (const channel::SecuritySetting& setting : parts_.allowed) {
        EndpointDescription& endpoint = endpoints.emplace_back();
        endpoint.endpoint_url = url.view().empty() ? String{url_} : url;
        endpoint.server.application_uri = String{parts_.application_uri};
        endpoint.server.application_name = LocalizedText{"", "a scripted server"};
        endpoint.server.application_type = ApplicationType::Server;
        endpoint.server.discovery_urls.push_back(endpoint.endpoint_url);
        if (parts_.identity != nullptr) {
            endpoint.server_certificate = ByteString{parts_.identity->certificates.front().der()};
        }
        endpoint.security_mode = setting.mode;
        endpoint.security_policy_uri = String{setting.policy->uri};
        endpoint.user_identity_tokens.push_back(
            token_policy("anonymous", UserTokenType::Anonymous));
        if (!setting.policy->is_none()) {
            endpoint.user_identity_tokens.push_back(token_policy("user", UserTokenType::UserName));
        }
        endpoint.transport_profile_uri =
            "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
    }
    return endpoints;
}

Result<CreateSessionResponse> ScriptedServer::create_session(const CreateSessionRequest& request)
{
    CreateSessionResponse response;
    response.session_id = NodeId{1, ++last_session_};
    response.authentication_token = NodeId{1, 1'000'000 + last_session_};
    response.revised_session_timeout = request.requested_session_timeout;
    response.server_nonce = detail::new_nonce(random_);
    if (parts_.identity != nullptr) {
        response.server_certificate = ByteString{parts_.identity->certificates.front().der()};
    }
    for (EndpointDescription& endpoint : endpoints(request.endpoint_url)) {
        response.server_endpoints.push_back(std::move(endpoint));
    }
    auto signature =
        detail::sign_nonce(channel().security(), parts_.identity, request.client_certificate.span(),
                           request.client_nonce.span());
    if (!signature) {
        return fail(signature.error());
    }
    response.server_signature = *std::move(signature);
    return response;
}

ActivateSessionResponse ScriptedServer::activate_session()
{
    ActivateSessionResponse response;
    response.server_nonce = detail::new_nonce(random_);
    return response;
}

void ScriptedServer::accept_session()
{
    expect<CreateSessionRequest>().reply(
        [this](const CreateSessionRequest& request) { return create_session(request); });
    expect<ActivateSessionRequest>().reply(
        [this](const ActivateSessionRequest&) { return activate_session(); });
}

ReadResponse ScriptedServer::read_own(const ReadRequest& request) const
{
    ReadResponse response;
    const DateTime now = world_.clock().now();
    for (const ReadValueId& item : request.nodes_to_read) {
        DataValue& result = response.results.emplace_back();
        if (item.attribute_id != value_attribute) {
            result = DataValue{status::Bad_AttributeIdInvalid};
        } else if (item.node_id.is(id::Server_ServerStatus_State)) {
            result = DataValue{Variant{std::int32_t{0}}}; // Running
        } else if (item.node_id.is(id::Server_ServerStatus)) {
            ServerStatusDataType status;
            status.start_time = first_day;
            status.current_time = now;
            result = DataValue{Variant{ExtensionObject::from(status)}};
        } else if (item.node_id.is(id::Server_NamespaceArray)) {
            Array<String> uris{"http://opcfoundation.org/UA/", String{parts_.application_uri}};
            result = DataValue{Variant{std::move(uris)}};
        } else if (item.node_id.is(id::Server_ServerArray)) {
            result = DataValue{Variant{Array<String>{String{parts_.application_uri}}}};
        } else {
            result = DataValue{status::Bad_NodeIdUnknown};
        }
        result.source_timestamp = now;
        result.server_timestamp = now;
    }
    return response;
}

void ScriptedServer::accept_clients()
{
    by_itself<FindServersRequest>([this](const FindServersRequest& request) {
        FindServersResponse response;
        response.servers.push_back(endpoints(request.endpoint_url).front().server);
        return response;
    });
    by_itself<GetEndpointsRequest>([this](const GetEndpointsRequest& request) {
        GetEndpointsResponse response;
        for (EndpointDescription& endpoint : endpoints(request.endpoint_url)) {
            response.endpoints.push_back(std::move(endpoint));
        }
        return response;
    });
    by_itself<CreateSessionRequest>(
        [this](const CreateSessionRequest& request) { return create_session(request); });
    by_itself<ActivateSessionRequest>(
        [this](const ActivateSessionRequest&) { return activate_session(); });
    by_itself<CloseSessionRequest>(
        [](const CloseSessionRequest&) { return CloseSessionResponse{}; });
    by_itself<ReadRequest>([this](const ReadRequest& request) { return read_own(request); },
                           [](const ReadRequest& request) {
                               const auto& items = request.nodes_to_read;
                               return std::all_of(items.begin(), items.end(),
                                                  [](const ReadValueId& item) {
                                                      return item.node_id.namespace_index() == 0;
                                                  });
                           });
}

} // namespace busbar::harness
