#include "core.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>

#include "base_services.hpp"
#include "channel/buffer_bounds.hpp"
#include "peer_link.hpp"
#include "server/attribute/write_effects.hpp"
#include "server/session/session_record.hpp"
#include "server/subscription/sampler.hpp"
#include "type_table.hpp"

namespace busbar::server::detail {

namespace {

void tell_closed(LogSink& log, const Session& session, StatusCode status)
{
    const char* const cause = session.end == SessionEnd::CloseSession ? "CloseSession"
                              : session.end == SessionEnd::Timeout    ? "Timeout"
                                                                      : "Terminated";
    const std::array fields{RecordField{"WasActivated", Variant{session.is_activated}},
                            RecordField{"Cause", Variant{cause}}};
    Record record{RecordKind::SessionClosed, LogLevel::Info, "session"};
    record.text = "\"" + printable(session.name) + "\" ended: " + std::string{name(status)};
    record.status = status;
    record.actor = actor_of(session, session.end_mark);
    record.certificate = certificate_of(session);
    record.fields = fields;
    tell(log, record);
}

std::uint32_t random_channel_id(crypto::Random& random)
{
    std::array<std::byte, 4> bytes{};
    static_cast<void>(random.fill(bytes)); // without randomness it begins at 1
    return std::max(std::bit_cast<std::uint32_t>(bytes), 1U);
}

} // namespace

Core::Core(ServerConfig c, const ServerEnvironment& e, model::AddressSpace space, std::uint16_t own)
    : config{std::move(c)}, guards{e, rationed_log}, environment{guards.environment()},
      own_namespace{own}, life{e.wall_clock->now()}, address_space{std::move(space)},
      kept_memory{kept_bytes(config.limits)}, sources{e.waker, guards.report().log, &kept_memory},
      assembly{config.limits.max_assembly}, spares{config.limits.transport.send_buffer_size},
      logins{config.limits}, channel_guard{config.limits},
      diagnostics_needs{address_space, config,   *environment.wall_clock,
                        life,          counters, sessions,
                        subscriptions, own,      conformance},
      subscription_needs{address_space, sources,  types,         config.limits,
                         environment,   counters, server_object, rationed_log},
      session_needs{config,          environment, guards, rationed_log, sessions, logins,
                    password_checks, counters,    *this,  own,          nullptr,  life.start_time},
      attribute_needs{address_space,
                      sources,
                      std::make_unique<DefinitionChecks>(),
                      config.limits,
                      environment.access,
                      *environment.wall_clock,
                      server_object,
                      *this,
                      config.locale_ids,
                      life.start_time},
      view_needs{address_space, config.limits, *environment.random, environment.access, late_nodes},
      certificate_watch{*environment.log}, next_channel_id{random_channel_id(*e.random)}
{
    subscription_needs.start_time = life.start_time;
    add_base_services(services);
}

void Core::add(ModuleTable modules)
{
    for (const Module* module : modules) {
        module->add_to(*this);
    }
    // Last, since a table of all types, if there is one, includes these.
    types.add(0, type_table<AnonymousIdentityToken, UserNameIdentityToken, X509IdentityToken,
                            DataChangeFilter, Argument, EnumValueType, EUInformation, Range>());
}

void Core::log(LogLevel level, std::string_view source, std::string_view text)
{
    const std::int64_t minute = environment.wall_clock->now().unix_seconds() / 60;
    if (minute != log_minute_) {
        if (log_lines_ > limits().max_log_lines_per_minute) {
            environment.log->write(LogLevel::Warning, "server",
                                   std::to_string(log_lines_ - limits().max_log_lines_per_minute) +
                                       " lines were left out");
        }
        log_minute_ = minute;
        log_lines_ = 0;
    }
    if (++log_lines_ <= limits().max_log_lines_per_minute) {
        environment.log->write(level, source, text);
    }
}

void Core::watch_certificate(TimePoint now)
{
    if (!config.identity) {
        return;
    }
    std::vector<std::string> hosts = config.host_names;
    if (const auto url = channel::EndpointUrl::parse(config.endpoint_url)) {
        hosts.push_back(url->host);
    }
    const DateTime today = environment.wall_clock->now();
    const DateTime next =
        certificate_watch.check(config.identity->certificates.front(), today, hosts);
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    certificate_check = now + Ticks{next.ticks - today.ticks};
}

PeerLink* Core::find_link(std::uint64_t link_id) const
{
    const auto found =
        std::lower_bound(links.begin(), links.end(), link_id,
                         [](const PeerLink* link, std::uint64_t id) { return link->id() < id; });
    return found != links.end() && (*found)->id() == link_id ? *found : nullptr;
}

void Core::claim()
{
    if (assess_all != nullptr) {
        conformance = assess_all(*this);
        return;
    }
    // A Connection speaks it, whatever carries the bytes.
    ProfileAssessment transport;
    transport.name = "TransportUaTcp";
    transport.uri = "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
    transport.is_claimed = true;
    conformance.profiles = {transport};
}

std::size_t Core::kept_bytes(const ServerLimits& limits)
{
    constexpr std::size_t most = 16U << 20U;
    return std::min<std::size_t>(most,
                                 channel::detail::completed(limits.transport).max_message_size);
}

void Core::sweep()
{
    while (!to_sweep.empty()) {
        PeerLink* link = to_sweep.back();
        to_sweep.pop_back();
        link->sweep();
    }
    subscriptions.sampler().tell_sources();
    kept_memory.note(latest);
}

void Core::close_session(Session& session, StatusCode status, bool deletes_subscriptions)
{
    if (session.peer != nullptr) {
        session.peer->end_operations(session, status);
    }
    // Requests from before it moved to its present channel are on another connection.
    for (auto link = links.begin(); link != links.end() && session.pending_operations != 0;
         ++link) {
        (*link)->end_operations(session, status);
    }
    subscriptions.session_ends(session, deletes_subscriptions);
    busbar::detail::attempt([&] { tell_closed(rationed_log, session, status); });
    diagnostics->remove(session);
    sessions.remove(session);
}

void Core::session_activated(Session& session)
{
    subscriptions.session_moved(session);
    // Keep the session even if its diagnostics nodes cannot be created.
    busbar::detail::guarded(rationed_log, "diagnostics of a session",
                            [&] { diagnostics->add(session); });
}

void Core::user_changed(Session& session, TimePoint now)
{
    subscriptions.user_changed(session, now);
}

std::uint32_t Core::cancel(const Session& session, std::uint32_t request_handle)
{
    std::uint32_t count = 0;
    // The session may have pending requests on an earlier channel.
    for (PeerLink* link : links) {
        count += link->cancel(session, request_handle);
    }
    return count;
}

void Core::kept_values_written()
{
    counters.take_flag(address_space, {sessions.size(), subscriptions.size()});
    diagnostics->take_flag();
}

/// Makes one pass through all items, however many were written.
bool Core::wants_node_ids() const
{
    return rationed_log.wants(RecordKind::AttributeWritten);
}

void Core::written(const Session* session, const RequestMark& mark, const WriteRequest& request,
                   std::span<const model::NodeHandle> nodes,
                   FunctionRef<StatusCode(std::size_t)> result)
{
    record_write(rationed_log, session, mark, request, result);
    announce_semantics(request, nodes, result);
}

void Core::announce_semantics(const WriteRequest& request, std::span<const model::NodeHandle> nodes,
                              FunctionRef<StatusCode(std::size_t)> result)
{
    if (subscriptions.item_count() == 0) {
        return;
    }
    const auto variables = find_semantic_changes(address_space, request, nodes, result);
    if (variables.empty()) {
        return;
    }
    subscriptions.announce_change(variables, ValueQueue::semantics_changed_bit);
    for (const NodeId& variable : variables) {
        events->announce_semantics(variable);
    }
}

void Core::given_up(const Session& session, const RequestMark& mark, const WriteRequest& request,
                    std::span<const model::NodeHandle> nodes,
                    FunctionRef<StatusCode(std::size_t)> result)
{
    record_write(rationed_log, &session, mark, request, result);
    announce_semantics(request, nodes, result);
}

void Core::model_changed()
{
    events->announce_model_changes();
}

} // namespace busbar::server::detail
