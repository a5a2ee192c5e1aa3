#include "dispatch.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <busbar/core/text.hpp>
#include <busbar/types/history.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/query.hpp>
#include <busbar/types/subscription.hpp>

#include "link.hpp"
#include "server/attribute/read.hpp"
#include "server/attribute/write.hpp"
#include "server/method/call.hpp"
#include "server/node_management/node_management_services.hpp"
#include "server/session/session_services.hpp"
#include "server/session/user_expiry.hpp"
#include "server/subscription/monitored_item_services.hpp"
#include "server/subscription/publish_queue.hpp"
#include "server/subscription/subscription_services.hpp"
#include "server/view/view_services.hpp"

namespace busbar::server::detail {

namespace {

/// A request on its way to its service.
struct Incoming {
    std::vector<std::byte> message;
    RequestHeader header;
    Reply reply;
    /// Where the parameters begin in the message, behind the header.
    std::size_t offset;
};

/// What a service needs of the session that the request names.
enum class Need : std::uint8_t {
    Nothing,   // the token is not looked at
    Known,     // a session; the service itself checks the rest
    Activated, // an activated session of this channel
};

struct Service {
    std::uint32_t encoding_id;
    Need need;
    /// Also works while the server shuts down.
    bool is_for_shutdown;
    /// Null: known, but not supported.
    void (*run)(ServiceContext& context, Incoming& incoming);
};

template <auto Function, typename Request, typename Response>
void run_function(ServiceContext& context, Incoming& incoming)
{
    const Core& core = context.core;
    binary::Reader reader{std::span{incoming.message}.subspan(incoming.offset),
                          binary::Strings::Borrow, &core.types, core.limits().decode};
    Request request;
    decode_parameters(reader, request);
    if (reader.ok() && reader.remaining() != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok()) {
        return context.link.fault(incoming.reply, reader.status());
    }
    Response response;
    const StatusCode status = Function(context, request, response);
    if (status.is_bad()) {
        context.core.diagnostics.count_fault(context.session, Request::binary_encoding_id, status);
        return context.link.fault(incoming.reply, status);
    }
    response.response_header = context.link.response_header(incoming.reply, status);
    context.link.respond(incoming.reply, Response::binary_encoding_id,
                         [&](binary::Writer& writer) { encode(writer, response); });
    context.link.recycle(std::move(incoming.message));
}

template <typename Request, std::unique_ptr<Operation> (*Make)()>
void run_operation(ServiceContext& context, Incoming& incoming)
{
    if (!context.link.has_place_for_operation()) {
        context.core.sweep(); // no operation is running, and some may have answered meanwhile
    }
    if (!context.link.has_place_for_operation()) {
        return context.link.fault(incoming.reply, status::Bad_ServerTooBusy);
    }
    context.link.start(Make(), std::move(incoming.message), incoming.offset,
                       {Request::binary_encoding_id, incoming.header.timeout_hint, incoming.reply},
                       context);
}

template <auto Function, typename Request, typename Response>
constexpr Service function(Need need, bool is_for_shutdown = false)
{
    return {Request::binary_encoding_id, need, is_for_shutdown,
            run_function<Function, Request, Response>};
}
template <typename Request, std::unique_ptr<Operation> (*Make)()>
constexpr Service operation(Need need, bool is_for_shutdown = false)
{
    return {Request::binary_encoding_id, need, is_for_shutdown, run_operation<Request, Make>};
}
template <typename Request>
constexpr Service unsupported()
{
    return {Request::binary_encoding_id, Need::Nothing, true, nullptr};
}

/// Every request of Part 4, by encoding id.
constexpr auto services = [] {
    std::array table{
        function<find_servers, FindServersRequest, FindServersResponse>(Need::Nothing),
        function<get_endpoints, GetEndpointsRequest, GetEndpointsResponse>(Need::Nothing),
        unsupported<RegisterServerRequest>(),
        unsupported<RegisterServer2Request>(),
        unsupported<FindServersOnNetworkRequest>(),
        function<create_session, CreateSessionRequest, CreateSessionResponse>(Need::Nothing),
        operation<ActivateSessionRequest, make_activate_session>(Need::Known),
        function<close_session, CloseSessionRequest, CloseSessionResponse>(Need::Known, true),
        function<cancel, CancelRequest, CancelResponse>(Need::Activated),
        function<add_nodes, AddNodesRequest, AddNodesResponse>(Need::Activated),
        function<add_references, AddReferencesRequest, AddReferencesResponse>(Need::Activated),
        function<delete_nodes, DeleteNodesRequest, DeleteNodesResponse>(Need::Activated),
        function<delete_references, DeleteReferencesRequest, DeleteReferencesResponse>(
            Need::Activated),
        operation<BrowseRequest, make_browse>(Need::Activated),
        operation<BrowseNextRequest, make_browse_next>(Need::Activated),
        function<translate_browse_paths, TranslateBrowsePathsToNodeIdsRequest,
                 TranslateBrowsePathsToNodeIdsResponse>(Need::Activated),
        function<register_nodes, RegisterNodesRequest, RegisterNodesResponse>(Need::Activated),
        function<unregister_nodes, UnregisterNodesRequest, UnregisterNodesResponse>(
            Need::Activated),
        unsupported<QueryFirstRequest>(),
        unsupported<QueryNextRequest>(),
        operation<ReadRequest, make_operation<ReadOperation>>(Need::Activated, true),
        operation<WriteRequest, make_operation<WriteOperation>>(Need::Activated),
        unsupported<HistoryReadRequest>(),
        unsupported<HistoryUpdateRequest>(),
        operation<CallRequest, make_operation<CallOperation>>(Need::Activated),
        function<create_monitored_items, CreateMonitoredItemsRequest, CreateMonitoredItemsResponse>(
            Need::Activated),
        function<modify_monitored_items, ModifyMonitoredItemsRequest, ModifyMonitoredItemsResponse>(
            Need::Activated),
        function<set_monitoring_mode, SetMonitoringModeRequest, SetMonitoringModeResponse>(
            Need::Activated),
        function<set_triggering, SetTriggeringRequest, SetTriggeringResponse>(Need::Activated),
        function<delete_monitored_items, DeleteMonitoredItemsRequest, DeleteMonitoredItemsResponse>(
            Need::Activated),
        function<create_subscription, CreateSubscriptionRequest, CreateSubscriptionResponse>(
            Need::Activated),
        function<modify_subscription, ModifySubscriptionRequest, ModifySubscriptionResponse>(
            Need::Activated),
        function<set_publishing_mode, SetPublishingModeRequest, SetPublishingModeResponse>(
            Need::Activated),
        operation<PublishRequest, make_operation<PublishOperation>>(Need::Activated),
        operation<RepublishRequest, make_operation<RepublishOperation>>(Need::Activated),
        function<transfer_subscriptions, TransferSubscriptionsRequest,
                 TransferSubscriptionsResponse>(Need::Activated),
        function<delete_subscriptions, DeleteSubscriptionsRequest, DeleteSubscriptionsResponse>(
            Need::Activated),
    };
    std::sort(table.begin(), table.end(),
              [](const Service& a, const Service& b) { return a.encoding_id < b.encoding_id; });
    return table;
}();

const Service* find_service(const NodeId& encoding_id)
{
    if (encoding_id.namespace_index() != 0 || !encoding_id.is_numeric()) {
        return nullptr;
    }
    const auto* const found = std::lower_bound(
        services.begin(), services.end(), encoding_id.numeric(),
        [](const Service& service, std::uint32_t id) { return service.encoding_id < id; });
    return found != services.end() && found->encoding_id == encoding_id.numeric() ? found : nullptr;
}

tl::unexpected<Refusal> refuse_session(StatusCode status, std::string found, std::string remedy)
{
    return refuse({status, "authenticationToken", std::move(found), "Part 4, 5.7.2.1 and 5.7.3.1",
                   std::move(remedy)});
}

/// The session that the request belongs to, if the service may be used with it.
Checked<Session*> find_session(Core& core, const Link& link, const RequestHeader& header, Need need,
                               TimePoint now)
{
    if (need == Need::Nothing) {
        return nullptr;
    }
    Session* session = core.sessions.find(header.authentication_token);
    if (session == nullptr) {
        return refuse_session(status::Bad_SessionIdInvalid, "no session has it",
                              "The session may have expired; the client has to create another");
    }
    if (need == Need::Activated) {
        if (session->link != &link) {
            return refuse_session(status::Bad_SecureChannelIdInvalid,
                                  "\"" + printable(session->name) +
                                      "\" is used over another channel than its own",
                                  "After a reconnection the client has to activate its session");
        }
        if (!session->is_activated) {
            const std::string session_name = printable(session->name);
            ++core.diagnostics.summary.session_abort_count;
            core.close_session(*session, status::Bad_SessionClosed); // Part 4, 5.7.3.1
            return refuse_session(status::Bad_SessionNotActivated,
                                  "\"" + session_name + "\" was never activated", {});
        }
        expire_user(core, *session, now);
        session->touch(now);
    }
    return session;
}

/// The whole header but its additionalHeader: no service uses it, so nothing is made of it.
void decode_header(binary::Reader& reader, RequestHeader& header)
{
    decode(reader, header.authentication_token);
    decode(reader, header.timestamp);
    decode(reader, header.request_handle);
    decode(reader, header.return_diagnostics);
    decode(reader, header.audit_entry_id);
    decode(reader, header.timeout_hint);
    skip_extension_object(reader);
}

/// What sends one to a server does not speak the protocol.
bool is_response(const Core& core, const NodeId& encoding_id)
{
    const StructureType* type = core.types.find(encoding_id);
    return type != nullptr && type->name.ends_with("Response");
}

void run(const Service* service, Core& core, Link& link, Incoming& incoming, TimePoint now)
{
    if (service == nullptr || service->run == nullptr) {
        const std::uint32_t id = service != nullptr ? service->encoding_id : 0;
        core.diagnostics.count_fault(nullptr, id, status::Bad_ServiceUnsupported);
        return link.fault(incoming.reply, status::Bad_ServiceUnsupported);
    }
    if (core.is_shutting_down() && !service->is_for_shutdown) {
        return link.fault(incoming.reply, status::Bad_Shutdown);
    }
    const RequestFault::Serving serving{core.guards.request(), link, incoming.reply.request_id};
    const auto session = find_session(core, link, incoming.header, service->need, now);
    if (!session) {
        core.diagnostics.count_fault(nullptr, service->encoding_id, session.error().status);
        explain(link.log(), "session", session.error());
        return link.fault(incoming.reply, session.error().status);
    }
    if (*session != nullptr) {
        core.diagnostics.count_request(**session, service->encoding_id,
                                       core.environment.wall_clock->now());
        incoming.reply.max_size = (*session)->max_response_message_size;
    }
    ServiceContext context{core, link, *session, now};
    service->run(context, incoming);
}

} // namespace

void dispatch(Core& core, Link& link, std::vector<std::byte> message, std::uint32_t request_id,
              TimePoint now)
{
    Incoming incoming{std::move(message), {}, {request_id, 0, 0}, 0};
    binary::Reader reader{incoming.message, binary::Strings::Borrow, &core.types,
                          core.limits().decode};
    NodeId encoding_id;
    decode(reader, encoding_id);
    const Service* service = find_service(encoding_id);
    if (service == nullptr && is_response(core, encoding_id)) {
        return link.close({status::Bad_TcpMessageTypeInvalid, "message type",
                           "a response, which no server gets", "Part 6, 7.1.2.2",
                           "Find out what connects to this port"});
    }
    // Every request begins with its header (Part 4, 7.32); those that are not known may too.
    decode_header(reader, incoming.header);
    incoming.offset = reader.offset();
    if (reader.ok()) {
        incoming.reply.request_handle = incoming.header.request_handle;
    } else if (service != nullptr || encoding_id.is_null()) {
        return link.fault(incoming.reply, reader.status());
    }
    run(service, core, link, incoming, now);
}

} // namespace busbar::server::detail
