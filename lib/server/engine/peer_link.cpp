#include "peer_link.hpp"

#include <algorithm>
#include <limits>

#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

#include "server/users/login_guard.hpp"

namespace busbar::server::detail {

namespace {

channel::ServerChannelConfig channel_config(Core& core, std::string_view address)
{
    channel::ServerChannelConfig config;
    config.limits = core.limits().transport;
    config.min_lifetime = core.limits().min_token_lifetime;
    config.max_lifetime = core.limits().max_token_lifetime;
    config.source = network_of(address);
    config.spares = &core.spares;
    config.known_certificates = &core.known_certificates;
    config.channel_id = core.next_channel_id++;
    if (core.next_channel_id == 0) {
        core.next_channel_id = 1;
    }
    for (const EndpointConfig& endpoint : core.config.endpoints) {
        config.allowed.push_back(endpoint.security);
    }
    if (core.config.has_open_discovery) {
        config.allowed.push_back({});
    }
    return config;
}

channel::ChannelEnvironment channel_environment(Core& core, LogSink& log, channel::OpenGate& gate,
                                                channel::OpenWorker* worker)
{
    const ServerEnvironment& from = core.environment;
    return {
        .random = from.random,
        .wall_clock = from.wall_clock,
        .log = &log,
        .validator = from.validator,
        .identity = core.config.identity ? &*core.config.identity : nullptr,
        .budget = &core.assembly,
        .gate = &gate,
        .worker = worker,
        .key_log = from.key_log,
        .chunk_hook = from.chunk_hook,
    };
}

Refusal no_session(const ServerLimits& limits)
{
    const auto seconds =
        std::chrono::duration_cast<std::chrono::seconds>(limits.sessionless_timeout).count();
    return {status::Bad_Timeout, "session timeout",
            "no activated session within " + std::to_string(seconds) + " s", "Part 4, 5.7.2.1",
            "A client that only asks for endpoints has to close its connection"};
}

Refusal takes_nothing(const ServerLimits& limits)
{
    const auto seconds =
        std::chrono::duration_cast<std::chrono::seconds>(limits.send_timeout).count();
    return {status::Bad_ConnectionClosed, "send timeout",
            "the peer took none of its answers for " + std::to_string(seconds) + " s",
            "limit send_timeout", "Look after the network and the client"};
}

} // namespace

void PeerLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    core_.log(level, source, std::string{address_} + ": " + std::string{text});
}

void PeerLog::record(const Record& record)
{
    Record of_peer = record;
    of_peer.actor.address = address_;
    core_.rationed_log.record(of_peer);
}

bool PeerLog::wants(RecordKind kind) const
{
    return core_.rationed_log.wants(kind);
}

class PeerLink::Running {
public:
    Running(PeerLink& link, TimePoint now) : link_{link}
    {
        link_.is_running_ = true;
        link_.now_ = now;
        link_.core_.latest = now;
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    ~Running()
    {
        link_.is_running_ = false;
        busbar::detail::guarded(link_.log_, "the end of a call", [&] { link_.core_.sweep(); });
    }

private:
    PeerLink& link_;
};

PeerLink::PeerLink(Core& core, std::string_view peer_address, TimePoint now)
    : core_{core}, id_{core.next_link_id++}, peer_address_{printable(peer_address)},
      log_{core, peer_address_}, gate_{core.channel_guard, core.limits(), peer_address},
      work_{core, *this, peer_address}, channel_{channel_config(core, peer_address),
                                                 channel_environment(core, log_, gate_,
                                                                     work_.if_there()),
                                                 now},
      created_{now}, now_{now}, session_check_{now + core.limits().sessionless_timeout}
{
    // So that ending a request or the connection needs no memory.
    events_.reserve(2);
    core_.to_sweep.reserve(core_.links.size() + 1);
    core_.links.push_back(this);
    trust_peer();
}

PeerLink::~PeerLink()
{
    handle_closed(status::Good, {});
    if (waits_for_sweep_) {
        std::erase(core_.to_sweep, this);
    }
    if (mark_.empty()) {
        core_.changed.remove(this);
    }
    std::erase(core_.links, this);
    if (core_.is_shutting_down() && core_.links.empty()) {
        core_.shutdown_deadline = core_.latest; // there is no client to wait for
    }
}

Result<void> PeerLink::reverse_hello(std::string_view endpoint_url)
{
    session_check_ = no_deadline; // until the client uses the connection
    Result<void> said = fail(status::Bad_OutOfMemory);
    survive([&] { said = channel_.reverse_hello(core_.config.application_uri, endpoint_url); });
    return said;
}

Result<void> PeerLink::feed(std::span<const std::byte> in, TimePoint now)
{
    const Running running{*this, now};
    if (session_check_ == no_deadline) {
        session_check_ = now + core_.limits().sessionless_timeout;
    }
    Result<void> fed;
    survive([&] {
        fed = channel_.feed(in, now);
        work(now);
    });
    return fed;
}

std::optional<ConnectionEvent> PeerLink::next_event()
{
    if (events_.empty()) {
        return std::nullopt;
    }
    ConnectionEvent event = std::move(events_.front());
    events_.erase(events_.begin());
    return event;
}

std::span<const std::byte> PeerLink::output() const
{
    return has_given_up_ ? std::span<const std::byte>{} : channel_.output();
}

void PeerLink::consume(std::size_t size)
{
    const Running running{*this, now_};
    channel_.consume(size);
    has_progressed_ = true;
    if (output().empty()) {
        send_check_ = no_deadline;
    }
    if (!has_more_) { // otherwise other connections come first
        survive([&] { work(now_); });
    }
}

TimePoint PeerLink::next_deadline() const
{
    TimePoint first = no_deadline;
    if (!output().empty()) {
        first = send_check_ == no_deadline ? now_ : send_check_;
    }
    if (is_closed()) {
        return first;
    }
    if (has_more_) {
        return now_;
    }
    first = std::min({first, channel_.next_deadline(), session_check_});
    for (const auto& operation : operations_) {
        first = std::min({first, operation->client_deadline(), operation->next_deadline()});
    }
    return first;
}

void PeerLink::handle_deadline(TimePoint now)
{
    const Running running{*this, now};
    survive([&] { pass_time(now); });
}

void PeerLink::pass_time(TimePoint now)
{
    check_silence(now);
    if (is_closed()) {
        return;
    }
    channel_.handle_deadline(now);
    // By index: an operation may not add others, but it may end all of them.
    for (std::size_t i = 0; i < operations_.size(); ++i) {
        ServiceOperation& operation = *operations_[i];
        if (!operation.is_finished() && operation.client_deadline() <= now) {
            operation.fault(status::Bad_Timeout); // Part 4, 7.32 timeoutHint
        } else if (!operation.is_finished() && operation.next_deadline() <= now) {
            serve(operation, [&] { operation.handle_deadline(now); });
        }
    }
    if (session_check_ <= now) {
        session_check_ = now + core_.limits().sessionless_timeout;
        if (!has_activated_session()) {
            close(no_session(core_.limits()));
        }
    }
    work(now);
}

void PeerLink::check_silence(TimePoint now)
{
    if (output().empty() || has_progressed_ || send_check_ == no_deadline) {
        has_progressed_ = false;
        send_check_ = output().empty() ? no_deadline : now + core_.limits().send_timeout;
    } else if (send_check_ <= now) {
        has_given_up_ = true;
        close(takes_nothing(core_.limits()));
    }
}

void PeerLink::work(TimePoint now)
{
    turn_ = Turn{Turn::units};
    give_turns(now);
    has_more_ = turn_.is_over();
    while (!has_more_ && has_room()) {
        auto event = channel_.next_event();
        if (!event) {
            break;
        }
        handle(*std::move(event), now);
        has_more_ = turn_.is_over();
    }
    core_.relieve_assembly(peer_address_);
    if (send_check_ == no_deadline && !output().empty()) {
        send_check_ = now + core_.limits().send_timeout;
        has_progressed_ = false;
    }
}

/// No work is done for a peer that does not take its answers.
bool PeerLink::has_room() const
{
    return channel_.unsent_size() <= core_.limits().max_send_queue / 2;
}

/// Also called while another connection is fed, whose work then precedes this one's.
void PeerLink::channel_work_done(StatusCode status, TimePoint now)
{
    now_ = now;
    survive([&] {
        channel_.work_done(status, now);
        if (!is_closed()) {
            return work(now);
        }
        while (auto event = channel_.next_event()) {
            handle(*std::move(event), now);
        }
    });
    mark();
}

void PeerLink::handle(channel::ChannelEvent event, TimePoint now)
{
    switch (event.kind) {
    case channel::ChannelEvent::Kind::Opened:
        events_.push_back({ConnectionEvent::Kind::Opened, {}, {}});
        break;
    case channel::ChannelEvent::Kind::Message:
        turn_.spend(Turn::units_of_request + event.body.size());
        dispatch(core_, *this, std::move(event.body), event.request_id, now);
        break;
    case channel::ChannelEvent::Kind::Closed:
        handle_closed(event.status, std::move(event.reason));
        break;
    case channel::ChannelEvent::Kind::Renewed:
    case channel::ChannelEvent::Kind::Aborted:
        break;
    }
}

/// A failed allocation outside any single request ends the connection, and nothing else.
void PeerLink::survive(FunctionRef<void()> work)
{
    const StatusCode thrown = busbar::detail::guarded(log_, "a connection", [&] { work(); });
    if (thrown.is_bad()) {
        busbar::detail::attempt([&] { close(thrown, "no memory"); });
        handle_closed(thrown, {});
    }
}

void PeerLink::serve(const Reply& reply, FunctionRef<void()> service)
{
    unanswered_ = reply.request_id;
    const StatusCode thrown = busbar::detail::guarded(log_, "a service", [&] {
        channel_.reserve_response(); // before anything is done that could not be answered
        service();
    });
    if (thrown.is_bad() && unanswered_) {
        fault(reply, thrown);
    }
    unanswered_.reset();
}

void PeerLink::serve(ServiceOperation& operation, FunctionRef<void()> part)
{
    const StatusCode thrown = busbar::detail::guarded(log_, "a service", [&] { part(); });
    if (thrown.is_bad()) {
        operation.fault(thrown);
    }
}

void PeerLink::handle_closed(StatusCode status, std::string reason)
{
    if (std::exchange(has_ended_, true)) {
        return;
    }
    for (const auto& operation : operations_) {
        if (!operation->is_finished()) {
            operation->drop();
        }
    }
    core_.sessions.unbind(*this);
    events_.push_back({ConnectionEvent::Kind::Closed, status, std::move(reason)});
}

bool PeerLink::has_activated_session() const
{
    return std::any_of(sessions_.begin(), sessions_.end(),
                       [](const Session* session) { return session->is_activated; });
}

void PeerLink::bind(Session& session)
{
    if (session.peer != this) {
        sessions_.push_back(&session);
        if (session.peer != nullptr) {
            session.peer->unbind(session);
        }
        session.peer = this;
    }
    trust_peer();
}

void PeerLink::unbind(Session& session)
{
    session.peer = nullptr;
    std::erase(sessions_, &session);
    trust_peer();
}

void PeerLink::trust_peer()
{
    constexpr auto all = std::numeric_limits<std::uint32_t>::max();
    channel_.limit_messages(has_activated_session() ? all : core_.limits().max_sessionless_message);
}

void PeerLink::close(StatusCode status, std::string_view reason)
{
    if (!is_closed()) {
        channel_.close(status, reason);
    }
    handle_closed(status, std::string{reason});
    mark();
}

void PeerLink::close(const Refusal& refusal)
{
    busbar::detail::attempt([&] { explain(log_, "connection", refusal); });
    close(refusal.status, refusal.check);
}

} // namespace busbar::server::detail
