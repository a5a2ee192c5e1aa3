#include "dispatch.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/types/history.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/query.hpp>
#include <busbar/types/subscription.hpp>

#include "peer_link.hpp"
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
    PeerLink& link;
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
    void (*run)(Core& core, ServiceContext& context, Incoming& incoming);
};

/// What a service set gets.
template <auto Needs>
using NeedsOf = std::remove_reference_t<decltype(std::declval<Core&>().*Needs)>;
template <typename Request, typename Response, typename Needs>
using ServiceFunction = StatusCode(Needs&, ServiceContext&, const Request&, Response&);

template <typename Request, typename Response, auto Needs,
          ServiceFunction<Request, Response, NeedsOf<Needs>>* Function>
void run_function(Core& core, ServiceContext& context, Incoming& incoming)
{
    binary::Reader reader{std::span{incoming.message}.subspan(incoming.offset),
                          binary::Strings::Borrow, &core.types, core.limits().decode};
    Request request;
    decode_parameters(reader, request);
    if (reader.ok() && reader.remaining() != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok()) {
        return context.peer.fault(incoming.reply, reader.status());
    }
    Response response;
    const StatusCode status = Function(core.*Needs, context, request, response);
    if (status.is_bad()) {
        core.counters.count_fault(context.session, Request::binary_encoding_id, status);
        return context.peer.fault(incoming.reply, status);
    }
    response.response_header = context.peer.response_header(incoming.reply, status);
    context.peer.respond(incoming.reply, Response::binary_encoding_id,
                         [&](binary::Writer& writer) { encode(writer, response); });
    incoming.link.recycle(std::move(incoming.message));
}

template <typename Request, auto Make, auto Needs>
void run_operation(Core& core, ServiceContext& context, Incoming& incoming)
{
    PeerLink& link = incoming.link;
    if (!link.has_place_for_operation()) {
        core.sweep(); // no operation is running, and some may have answered meanwhile
    }
    if (!link.has_place_for_operation()) {
        return link.fault(incoming.reply, status::Bad_ServerTooBusy);
    }
    link.start(Make(core.*Needs), std::move(incoming.message), incoming.offset,
               {Request::binary_encoding_id, incoming.header.timeout_hint, incoming.reply},
               context);
}

template <typename T, typename Needs>
std::unique_ptr<ServiceOperation> make_operation(Needs& needs)
{
    return std::make_unique<T>(needs);
}

template <typename Request, typename Response, auto Needs,
          ServiceFunction<Request, Response, NeedsOf<Needs>>* Function>
constexpr Service function(Need need, bool is_for_shutdown = false)
{
    return {Request::binary_encoding_id, need, is_for_shutdown,
            run_function<Request, Response, Needs, Function>};
}
template <typename Request, auto Make, auto Needs>
constexpr Service operation(Need need, bool is_for_shutdown = false)
{
    return {Request::binary_encoding_id, need, is_for_shutdown,
            run_operation<Request, Make, Needs>};
}
template <typename Request>
constexpr Service unsupported()
{
    return {Request::binary_encoding_id, Need::Nothing, true, nullptr};
}

/// Every request of Part 4, by encoding id.
constexpr auto services = [] {
    std::array table{
        function<FindServersRequest, FindServersResponse, &Core::session_needs, find_servers>(
            Need::Nothing),
        function<GetEndpointsRequest, GetEndpointsResponse, &Core::session_needs, get_endpoints>(
            Need::Nothing),
        unsupported<RegisterServerRequest>(),
        unsupported<RegisterServer2Request>(),
        unsupported<FindServersOnNetworkRequest>(),
        function<CreateSessionRequest, CreateSessionResponse, &Core::session_needs, create_session>(
            Need::Nothing),
        operation<ActivateSessionRequest, make_activate_session, &Core::session_needs>(Need::Known),
        function<CloseSessionRequest, CloseSessionResponse, &Core::session_needs, close_session>(
            Need::Known, true),
        function<CancelRequest, CancelResponse, &Core::session_needs, cancel>(Need::Activated),
        operation<AddNodesRequest, make_add_nodes, &Core::node_management_needs>(Need::Activated),
        operation<AddReferencesRequest, make_add_references, &Core::node_management_needs>(
            Need::Activated),
        operation<DeleteNodesRequest, make_delete_nodes, &Core::node_management_needs>(
            Need::Activated),
        operation<DeleteReferencesRequest, make_delete_references, &Core::node_management_needs>(
            Need::Activated),
        operation<BrowseRequest, make_browse, &Core::view_needs>(Need::Activated),
        operation<BrowseNextRequest, make_browse_next, &Core::view_needs>(Need::Activated),
        operation<TranslateBrowsePathsToNodeIdsRequest, make_translate_browse_paths,
                  &Core::view_needs>(Need::Activated),
        function<RegisterNodesRequest, RegisterNodesResponse, &Core::view_needs, register_nodes>(
            Need::Activated),
        function<UnregisterNodesRequest, UnregisterNodesResponse, &Core::view_needs,
                 unregister_nodes>(Need::Activated),
        unsupported<QueryFirstRequest>(),
        unsupported<QueryNextRequest>(),
        operation<ReadRequest, make_operation<ReadOperation, const AttributeNeeds>,
                  &Core::attribute_needs>(Need::Activated, true),
        operation<WriteRequest, make_operation<WriteOperation, const AttributeNeeds>,
                  &Core::attribute_needs>(Need::Activated),
        unsupported<HistoryReadRequest>(),
        unsupported<HistoryUpdateRequest>(),
        operation<CallRequest, make_operation<CallOperation, const MethodNeeds>,
                  &Core::method_needs>(Need::Activated),
        operation<CreateMonitoredItemsRequest, make_create_monitored_items, &Core::subscriptions>(
            Need::Activated),
        operation<ModifyMonitoredItemsRequest, make_modify_monitored_items, &Core::subscriptions>(
            Need::Activated),
        operation<SetMonitoringModeRequest, make_set_monitoring_mode, &Core::subscriptions>(
            Need::Activated),
        function<SetTriggeringRequest, SetTriggeringResponse, &Core::subscriptions, set_triggering>(
            Need::Activated),
        operation<DeleteMonitoredItemsRequest, make_delete_monitored_items, &Core::subscriptions>(
            Need::Activated),
        function<CreateSubscriptionRequest, CreateSubscriptionResponse, &Core::subscriptions,
                 create_subscription>(Need::Activated),
        function<ModifySubscriptionRequest, ModifySubscriptionResponse, &Core::subscriptions,
                 modify_subscription>(Need::Activated),
        function<SetPublishingModeRequest, SetPublishingModeResponse, &Core::subscriptions,
                 set_publishing_mode>(Need::Activated),
        operation<PublishRequest, make_operation<PublishOperation, SubscriptionTable>,
                  &Core::subscriptions>(Need::Activated),
        operation<RepublishRequest, make_operation<RepublishOperation, SubscriptionTable>,
                  &Core::subscriptions>(Need::Activated),
        function<TransferSubscriptionsRequest, TransferSubscriptionsResponse, &Core::subscriptions,
                 transfer_subscriptions>(Need::Activated),
        function<DeleteSubscriptionsRequest, DeleteSubscriptionsResponse, &Core::subscriptions,
                 delete_subscriptions>(Need::Activated),
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
Checked<Session*> find_session(Core& core, const PeerLink& link, const RequestHeader& header,
                               Need need, TimePoint now)
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
        if (session->peer != &link) {
            return refuse_session(status::Bad_SecureChannelIdInvalid,
                                  "\"" + printable(session->name) +
                                      "\" is used over another channel than its own",
                                  "After a reconnection the client has to activate its session");
        }
        if (!session->is_activated) {
            const std::string session_name = printable(session->name);
            ++core.counters.summary.session_abort_count;
            core.close_session(*session, status::Bad_SessionClosed, false); // Part 4, 5.7.3.1
            return refuse_session(status::Bad_SessionNotActivated,
                                  "\"" + session_name + "\" was never activated", {});
        }
        expire_user(core.session_needs, *session, now);
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

void run(const Service* service, Core& core, PeerLink& link, Incoming& incoming, TimePoint now)
{
    if (service == nullptr || service->run == nullptr) {
        const std::uint32_t id = service != nullptr ? service->encoding_id : 0;
        core.counters.count_fault(nullptr, id, status::Bad_ServiceUnsupported);
        return link.fault(incoming.reply, status::Bad_ServiceUnsupported);
    }
    if (core.is_shutting_down() && !service->is_for_shutdown) {
        return link.fault(incoming.reply, status::Bad_Shutdown);
    }
    const RequestFault::Serving serving{core.guards.request(), &link, incoming.reply.request_id};
    const auto session = find_session(core, link, incoming.header, service->need, now);
    if (!session) {
        core.counters.count_fault(nullptr, service->encoding_id, session.error().status);
        explain(link.log(), "session", session.error());
        return link.fault(incoming.reply, session.error().status);
    }
    if (*session != nullptr) {
        core.counters.count_request(**session, service->encoding_id,
                                    core.environment.wall_clock->now());
        incoming.reply.max_size = (*session)->max_response_message_size;
    }
    ServiceContext context{link, *session, now};
    service->run(core, context, incoming);
}

} // namespace

void dispatch(Core& core, PeerLink& link, std::vector<std::byte> message, std::uint32_t request_id,
              TimePoint now)
{
    Incoming incoming{std::move(message), {}, {request_id, 0, 0}, 0, link};
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
