#include <busbar/client/client.hpp>

#include <algorithm>
#include <array>

#include "client/services/handlers.hpp"
#include "client_impl.hpp"

namespace busbar::client {

namespace {

/// Changes of state that wait for poll(); only connect() and close() make any outside of it.
constexpr std::size_t max_changes = 16;

channel::ChannelEnvironment with_log(channel::ChannelEnvironment environment, LogSink& log)
{
    environment.log = &log;
    return environment;
}

} // namespace

Client::Impl::Impl(Client& owner, ClientConfig c, const channel::ChannelEnvironment& e,
                   TimePoint start)
    : client{owner}, config{std::move(c)}, safe_log{*e.log}, environment{with_log(e, safe_log)},
      now{start}, back_off{config.reconnect}, reader{config.max_server_names},
      requests{config.max_requests, config.request_timeout}, subscriptions{owner,
                                                                           config.subscriptions}
{
}

/// Keeps time from going back, whatever clock is used.
void Client::Impl::tell(TimePoint time)
{
    now = std::max(now, time);
    busbar::detail::attempt([&] { requests.tell(now); }); // if this fails, it is told the next time
    transport.check(now);
}

/// Work that ran out of memory ends the connection, since its progress is unknown.
void Client::Impl::survive(FunctionRef<void()> work)
{
    const StatusCode thrown =
        busbar::detail::guarded(*environment.log, "a Client's work", [&] { work(); });
    if (thrown.is_bad()) {
        failure = thrown;
    }
}

/// Returns true if something had failed.
bool Client::Impl::end_failed()
{
    const StatusCode why = std::exchange(failure, StatusCode{});
    const bool is_settled =
        transport.is_none() && (state == ClientState::Waiting || state == ClientState::Closing ||
                                state == ClientState::Closed);
    if (!why.is_bad() || is_settled) {
        return why.is_bad();
    }
    survive([&] { lose(why); });
    return true;
}

void Client::Impl::set_state(ClientState next, StatusCode why)
{
    if (std::exchange(state, next) == next) {
        return;
    }
    if (why.is_bad()) {
        last_error = why;
    }
    if (changes.size() == max_changes) {
        changes.pop_front();
    }
    changes.emplace_back(next, why);
}

bool Client::Impl::announce()
{
    if (changes.empty()) {
        return false;
    }
    const auto [next, why] = changes.front();
    changes.pop_front();
    if (state_handler) {
        // A copy, since the handler may set another one.
        const auto handler = state_handler;
        handler(next, why);
    }
    return true;
}

bool Client::Impl::deliver()
{
    return requests.deliver(*environment.log);
}

bool Client::Impl::expire()
{
    return requests.expire(now);
}

bool Client::Impl::run_subscriptions()
{
    if (subscriptions.next_deadline() > now) {
        return false;
    }
    subscriptions.handle_deadline(now);
    return true;
}

bool Client::Impl::send_waiting()
{
    return state == ClientState::Ready && connection && requests.send_one(*connection, now);
}

TimePoint Client::Impl::next_deadline() const
{
    TimePoint next = std::min({requests.next_deadline(), subscriptions.next_deadline(),
                               transport.next_deadline(), attempt_ends_at});
    if (connection && transport.state() == detail::Transport::State::Up) {
        next = std::min(next, connection->next_deadline());
    }
    if (state == ClientState::Waiting && is_wanted && transport.is_none()) {
        next = std::min(next, retry_at);
    }
    if (state == ClientState::Connecting && transport.is_none()) {
        next = std::min(next, redial_at);
    }
    return state == ClientState::Ready ? std::min(next, keep_alive.next_deadline()) : next;
}

bool Client::Impl::has_work() const
{
    const bool has_told = !user_changes.empty() && user_changes.front().result.has_value();
    return failure.is_bad() || !changes.empty() || has_told || requests.has_results() ||
           transport.lost().has_value() ||
           (state == ClientState::Ready && requests.has_waiting()) ||
           (state == ClientState::Closing && transport.is_none());
}

Client::Client(ClientConfig config, const channel::ChannelEnvironment& environment, TimePoint now)
    : impl_{std::make_unique<Impl>(*this, std::move(config), environment, now)}
{
}
Client::~Client() = default;

void Client::connect(TimePoint now)
{
    impl_->tell(now);
    if (impl_->is_wanted) {
        return;
    }
    impl_->is_wanted = true;
    impl_->retry_at = impl_->now;
    impl_->failures_in_row = 0;
    impl_->back_off.reset();
    impl_->set_state(ClientState::Waiting, {});
}

void Client::close(TimePoint now, bool deletes_subscriptions)
{
    impl_->tell(now);
    impl_->deletes_subscriptions = deletes_subscriptions;
    if (impl_->state != ClientState::Closed) {
        impl_->begin_closing({});
    }
}

ClientState Client::state() const
{
    return impl_->state;
}

StatusCode Client::last_error() const
{
    return impl_->last_error;
}

const EndpointDescription* Client::endpoint() const
{
    return impl_->choice ? &impl_->choice->endpoint : nullptr;
}

void Client::on_state(std::function<void(ClientState, StatusCode)> handler)
{
    impl_->state_handler =
        detail::guarded_handler(log(), "Client::on_state handler", std::move(handler));
}

Duration Client::session_timeout() const
{
    const bool has_session = impl_->state == ClientState::Ready && impl_->config.wants_session;
    return has_session ? Duration{impl_->connection->session().timeout} : Duration::zero();
}

void Client::change_user(UserIdentity identity, std::function<void(StatusCode)> done)
{
    PendingUserChange change;
    change.identity = std::move(identity);
    change.done = detail::guarded_handler(log(), "Client::change_user handler", std::move(done));
    impl_->begin_user_change(std::move(change));
}

Subscriptions& Client::subscriptions()
{
    return impl_->subscriptions;
}

void Client::cancel(RequestId id)
{
    const auto handle = impl_->requests.cancel(id);
    if (handle && impl_->connection) {
        impl_->connection->cancel(*handle);
    }
}

const ServerInfo& Client::server() const
{
    return impl_->info;
}

TimePoint Client::now() const
{
    return impl_->now;
}

LogSink* Client::log() const
{
    return impl_->environment.log;
}

const binary::DecodeLimits& Client::decode_limits() const
{
    return impl_->config.decode;
}

const binary::TypeRegistry& Client::types() const
{
    return impl_->types;
}

RequestId Client::start(Encode encode, Handler<ResponseBody> handler, const RequestOptions& options)
{
    const ClientState state = impl_->state;
    return impl_->requests.add(std::move(encode), std::move(handler), options,
                               state == ClientState::Ready,
                               state == ClientState::Closing || state == ClientState::Closed);
}

std::optional<TransportOrder> Client::next_order()
{
    return impl_->transport.next_order();
}

void Client::connected(std::uint64_t order, TimePoint now)
{
    impl_->tell(now);
    if (impl_->transport.connected(order)) {
        impl_->survive([&] { impl_->use_connection(); });
    }
}

void Client::disconnected(std::uint64_t order, StatusCode why, TimePoint now,
                          std::string_view reason)
{
    impl_->tell(now);
    impl_->survive([&] { impl_->transport.disconnected(order, why, reason); });
}

Result<void> Client::feed(std::span<const std::byte> in, TimePoint now)
{
    impl_->tell(now);
    if (!impl_->connection || impl_->transport.state() != detail::Transport::State::Up) {
        return fail(status::Bad_ConnectionClosed);
    }
    if (!in.empty()) {
        impl_->keep_alive.heard(impl_->now);
    }
    Result<void> fed;
    impl_->survive([&] { fed = impl_->connection->feed(in, impl_->now); });
    return fed;
}

std::span<const std::byte> Client::output() const
{
    const bool has_transport = impl_->connection && !impl_->transport.is_none();
    return has_transport ? impl_->connection->output() : std::span<const std::byte>{};
}

void Client::consume(std::size_t size)
{
    if (impl_->connection) {
        impl_->connection->consume(size);
    }
}

TimePoint Client::next_deadline() const
{
    const Impl& impl = *impl_;
    return impl.has_work() ? impl.now : std::max(impl.now, impl.next_deadline());
}

void Client::handle_deadline(TimePoint now)
{
    impl_->tell(now);
}

bool Client::poll(TimePoint now, std::size_t max_steps)
{
    using Step = bool (Impl::*)();
    static constexpr std::array<Step, 8> steps{
        &Impl::announce, &Impl::tell_user_change, &Impl::deliver,           &Impl::expire,
        &Impl::receive,  &Impl::advance,          &Impl::run_subscriptions, &Impl::send_waiting};
    impl_->tell(now);
    impl_->end_failed();
    bool has_moved = true;
    while (has_moved) {
        has_moved = false;
        for (const Step step : steps) {
            if (max_steps == 0) {
                return true;
            }
            bool has_done = false;
            impl_->survive([&] { has_done = (impl_.get()->*step)(); });
            if (impl_->end_failed() || has_done) {
                has_moved = true;
                --max_steps;
                impl_->tell(impl_->now);
            }
        }
    }
    return false;
}

} // namespace busbar::client
