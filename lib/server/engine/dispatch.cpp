#include "peer_link.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

#include "core.hpp"
#include "run_service.hpp"
#include "server/rights/node_rights.hpp"
#include "server/session/session_services.hpp"

namespace busbar::server::detail {

namespace {

Unexpected<Refusal> refuse_session(StatusCode status, std::string found, std::string remedy)
{
    return refuse({status, "authenticationToken", std::move(found), "Part 4, 5.7.2.1 and 5.7.3.1",
                   std::move(remedy)});
}

/// Returns the request's session, if the service may be used with it.
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

/// Returns the part of the diagnostics that the user may see (Part 4, 7.12).
std::uint32_t allowed_diagnostics(const Core& core, const Session* session, std::uint32_t wanted)
{
    if ((wanted & diagnostic_bit::for_administrators) == 0) {
        return wanted;
    }
    // Supervisors and engineers, too: they write programs and read logs.
    static constexpr std::array roles{id::WellKnownRole_SecurityAdmin, id::WellKnownRole_Engineer,
                                      id::WellKnownRole_Supervisor};
    const bool is_known = session != nullptr && session->is_activated;
    const bool is_admin =
        is_known && (is_configure_admin(session->user) ||
                     std::any_of(roles.begin(), roles.end(), [&](std::uint32_t role) {
                         return has_role(core.address_space, session->user, NodeId{0, role});
                     }));
    return is_admin ? wanted : wanted & ~diagnostic_bit::for_administrators;
}

/// Decodes the header except its additionalHeader, which no service uses.
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

/// Returns whether a service works in the server's state, an enumeration of Part 5, 12.6.
StatusCode check_state(const Core& core, Lasts lasts)
{
    const Lasts least = core.countdown_heir != nullptr ? Lasts::InCountdown : Lasts::ToTheEnd;
    if (core.is_shutting_down() && lasts < least) {
        return status::Bad_Shutdown;
    }
    return core.life.state == ServerState::Failed && lasts < Lasts::WhenFailed
               ? status::Bad_ServerHalted
               : status::Good;
}

void run(const Service* service, Core& core, PeerLink& link, Incoming& incoming, TimePoint now)
{
    if (service == nullptr || service->run == nullptr) {
        const std::uint32_t id = service != nullptr ? service->encoding_id : 0;
        core.counters.count_fault(nullptr, id, status::Bad_ServiceUnsupported);
        return link.fault(incoming.reply, status::Bad_ServiceUnsupported);
    }
    if (const StatusCode ended = check_state(core, service->lasts); ended.is_bad()) {
        return link.fault(incoming.reply, ended);
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
    incoming.reply.return_diagnostics =
        allowed_diagnostics(core, *session, incoming.header.return_diagnostics);
    ServiceContext context{
        link, *session, now, {incoming.header.audit_entry_id.str(), incoming.header.timestamp}};
    service->run(core, context, incoming);
}

} // namespace

void run_operation(Core& core, ServiceContext& context, Incoming& incoming,
                   std::uint32_t encoding_id, FunctionRef<std::unique_ptr<ServiceOperation>()> make)
{
    PeerLink& link = incoming.link;
    if (!link.has_place_for_operation()) {
        core.sweep(); // no operation is running, and some may have answered meanwhile
    }
    if (!link.has_place_for_operation()) {
        return link.fault(incoming.reply, status::Bad_ServerTooBusy);
    }
    link.start(make(), std::move(incoming.message), incoming.offset,
               {encoding_id, incoming.header.timeout_hint, incoming.reply}, context);
}

void dispatch(Core& core, PeerLink& link, std::vector<std::byte> message, std::uint32_t request_id,
              TimePoint now)
{
    Incoming incoming{std::move(message), {}, {request_id, 0, 0, 0}, 0, link};
    binary::Reader reader{incoming.message, binary::Strings::Borrow, &core.types,
                          core.limits().decode};
    NodeId encoding_id;
    decode(reader, encoding_id);
    const Service* service = core.services.find(encoding_id);
    if (service == nullptr && is_response(encoding_id)) {
        return link.close({status::Bad_TcpMessageTypeInvalid, "message type",
                           "a response, which a server never receives", "Part 6, 7.1.2.2",
                           "Find out what connects to this port"});
    }
    // Every request begins with its header (Part 4, 7.32); unknown ones may too.
    decode_header(reader, incoming.header);
    incoming.offset = reader.offset();
    if (reader.ok()) {
        incoming.reply.request_handle = incoming.header.request_handle;
        incoming.reply.return_diagnostics =
            incoming.header.return_diagnostics & ~diagnostic_bit::for_administrators;
    } else if (service != nullptr || encoding_id.is_null()) {
        return link.fault(incoming.reply, reader.status());
    }
    const Reply reply = incoming.reply;
    link.serve(reply, [&] { run(service, core, link, incoming, now); });
}

} // namespace busbar::server::detail
