#include <busbar/net/server_loop.hpp>

#include <algorithm>
#include <csignal>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <asio/signal_set.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/running_server.hpp>

#include "discovery_registration.hpp"
#include "listeners.hpp"
#include "memory_return.hpp"
#include "pipe_waker.hpp"
#include "reverse_dialer.hpp"
#include "served_server.hpp"
#include "turn_away.hpp"

namespace busbar::net {

namespace {

using asio::ip::tcp;

/// Peers that are being told that there is no place for them.
constexpr std::size_t most_turned_away = 16;

constexpr std::chrono::hours longest_delay{24};

/// Between attempts to find memory for what is to be waited for.
constexpr std::chrono::milliseconds retry_pause{100};

} // namespace

struct ServerLoop::Impl {
    using ServedServer = detail::ServedServer;

    explicit Impl(LogSink& l)
        : log{l}, waker{context}, timer{context.get_executor()}, signals{context}, hangup{context}
    {
        events.on_activity = [this] {
            memory_return.note_activity(detail::now());
            after_activity();
        };
        events.on_opened = [this](std::uint64_t id) {
            for (const auto& dialer : dialers) {
                dialer->opened(id);
            }
        };
        events.on_ended = [this](std::uint64_t id) {
            for (const auto& dialer : dialers) {
                dialer->ended(id);
            }
        };
    }

    std::optional<std::uint64_t> adopt(tcp::socket socket, ServedServer::Direction direction,
                                       std::uint32_t listener = 0);
    /// Calls `work`, which may throw, and looks after what it gave others to do.
    template <typename Work>
    void guard(std::string_view name, Work work)
    {
        busbar::detail::guarded(log, name, work);
        after_activity();
    }
    /// Calls `work` with each server. There may be more of them afterwards.
    template <typename Work>
    void for_each(Work work)
    {
        for (std::size_t i = 0; i < served.size(); ++i) {
            work(*served[i]);
        }
    }
    void serve(server::Server& server);
    [[nodiscard]] Configured<void> check(const server::Server& next,
                                         const Handover& handover) const;
    [[nodiscard]] Configured<void> check_next(const server::Server& next) const;
    void retire();
    void after_activity();
    void await_deadline();
    void look_at_memory(TimePoint now);
    void begin_stop();
    void tell_to_stop();
    [[nodiscard]] bool resume();
    void run();
    void await_wake();
    void await_hangup();
    [[nodiscard]] bool has_stopped() const;

    busbar::detail::SafeLog log;
    asio::io_context context;
    detail::PipeWaker waker;
    detail::DeadlineTimer timer;
    detail::MemoryReturn memory_return;
    asio::signal_set signals;
    asio::signal_set hangup;
    std::function<void()> on_hangup;
    detail::TurnAway turn_away{most_turned_away};
    detail::Listeners listeners{context.get_executor(), log};
    ReverseConnectConfig reverse_connect;
    std::vector<std::unique_ptr<detail::ReverseDialer>> dialers;
    std::vector<std::unique_ptr<detail::DiscoveryRegistration>> registrations;
    detail::ServedEvents events;
    /// The last one serves, those before end. None before run().
    std::vector<std::unique_ptr<ServedServer>> served;
    std::uint64_t last_connection{0};
    bool awaits_hangup{false};
    bool is_stopping{false};
    bool is_told_to_stop{false}; // everything is
};

/// The connection's id, unless it is refused or gone already.
std::optional<std::uint64_t> ServerLoop::Impl::adopt(tcp::socket socket,
                                                     ServedServer::Direction direction,
                                                     std::uint32_t listener)
{
    const std::uint64_t id = ++last_connection;
    const auto adopted = served.back()->adopt(socket, {direction, listener}, id);
    if (adopted) {
        return id;
    }
    if (direction == ServedServer::Direction::FromClient &&
        adopted.error() != status::Bad_CommunicationError) {
        turn_away(std::move(socket), adopted.error(), "no place for a connection");
    }
    return std::nullopt;
}

/// What one connection did may have given others something to send.
void ServerLoop::Impl::after_activity()
{
    for_each([](ServedServer& each) { each.pump(); });
    retire();
    if (has_stopped()) {
        context.stop();
        return;
    }
    await_deadline();
}

/// Lets go of servers that went and have nobody any more; nothing of theirs is being called then.
void ServerLoop::Impl::retire()
{
    for (std::size_t i = 0; i + 1 < served.size();) {
        if (!served[i]->is_over()) {
            ++i;
            continue;
        }
        const auto released = std::move(served[i]->released);
        served.erase(served.begin() + static_cast<std::ptrdiff_t>(i));
        if (released) {
            busbar::detail::guarded(log, "Handover::released", released);
        }
    }
}

/// After an exception that may have kept anything from waiting for what comes next. False if it may
/// still be so.
bool ServerLoop::Impl::resume()
{
    const StatusCode thrown = busbar::detail::guarded(log, "resuming", [this] {
        asio::post(context, [this] { after_activity(); });
        listeners.resume();
        await_wake();
        await_hangup();
        if (is_stopping && !is_told_to_stop) {
            tell_to_stop();
        }
    });
    return thrown.is_good();
}

/// Until everything has stopped. What throws is put right again, now or when there is memory.
void ServerLoop::Impl::run()
{
    const auto work = asio::make_work_guard(context); // nothing may be waited for any more
    bool is_behind = false;
    while (!context.stopped()) {
        const StatusCode thrown = busbar::detail::guarded(log, "what the network called", [&] {
            is_behind ? context.run_for(retry_pause) : context.run();
        });
        if (is_behind || thrown.is_bad()) {
            is_behind = !resume();
        }
    }
}

void ServerLoop::Impl::await_wake()
{
    waker.wait([this] {
        for_each([this](ServedServer& each) {
            busbar::detail::guarded(log, "Server::handle_completions",
                                    [&each] { each.server().handle_completions(detail::now()); });
        });
        after_activity();
    });
}

/// Clients of servers that went were told; nobody waits for them longer than for those of this one.
bool ServerLoop::Impl::has_stopped() const
{
    return is_stopping && served.back()->is_over() &&
           std::ranges::all_of(registrations, [](const auto& one) { return one->is_stopped(); });
}

void ServerLoop::Impl::await_deadline()
{
    TimePoint deadline = memory_return.next_deadline();
    for_each(
        [&](ServedServer& each) { deadline = std::min(deadline, each.server().next_deadline()); });
    timer.await(deadline, [this] {
        const TimePoint now = detail::now();
        for_each([this, now](ServedServer& each) {
            if (each.server().next_deadline() <= now) {
                busbar::detail::guarded(log, "Server::handle_deadline",
                                        [&] { each.server().handle_deadline(now); });
            }
        });
        if (memory_return.next_deadline() <= now) {
            look_at_memory(now);
        }
        after_activity();
    });
}

void ServerLoop::Impl::look_at_memory(TimePoint now)
{
    if (memory_return.handle_deadline(now, detail::process_memory())) {
        detail::return_free_memory();
        memory_return.returned(detail::process_memory());
    }
}

void ServerLoop::Impl::serve(server::Server& server)
{
    served.push_back(std::make_unique<ServedServer>(server, context.get_executor(), events));
    server.start(detail::now());
}

void ServerLoop::Impl::begin_stop()
{
    if (!std::exchange(is_stopping, true)) {
        tell_to_stop();
    }
}

/// May throw, and is called once more then.
void ServerLoop::Impl::tell_to_stop()
{
    listeners.close();
    for (const auto& dialer : dialers) {
        dialer->stop();
    }
    for (const auto& registration : registrations) {
        registration->stop([this] { after_activity(); });
    }
    served.back()->server().begin_shutdown(detail::now(), "the server is being stopped");
    is_told_to_stop = true;
    after_activity();
}

ServerLoop::ServerLoop(LogSink& log) : impl_{std::make_unique<Impl>(log)} {}
ServerLoop::~ServerLoop() = default;

server::Waker& ServerLoop::waker()
{
    return impl_->waker;
}

Result<std::uint16_t> ServerLoop::listen(std::string_view address, std::uint16_t port,
                                         std::uint32_t listener)
{
    return impl_->listeners.add(address, port, listener);
}

void ServerLoop::stop_listening(std::uint16_t port)
{
    impl_->listeners.remove(port);
}

Result<void> ServerLoop::connect_to_clients(ReverseConnectConfig config)
{
    std::vector<channel::EndpointUrl> urls;
    for (const std::string& text : config.client_urls) {
        auto url = channel::EndpointUrl::parse(text);
        if (!url) {
            return fail(url.error());
        }
        urls.push_back(*std::move(url));
    }
    impl_->reverse_connect = std::move(config);
    for (channel::EndpointUrl& url : urls) {
        impl_->dialers.push_back(std::make_unique<detail::ReverseDialer>(
            impl_->context.get_executor(), impl_->log, std::move(url), impl_->reverse_connect,
            [impl = impl_.get()](tcp::socket socket) {
                return impl->adopt(std::move(socket), detail::ServedServer::Direction::ToClient);
            }));
    }
    return {};
}

Result<void> ServerLoop::register_with(DiscoveryRegistrationConfig config,
                                       const channel::ChannelEnvironment& environment)
{
    if (auto checked = client::Registration::check(config.settings); !checked) {
        return fail(checked.error());
    }
    if (const auto url = channel::EndpointUrl::parse(config.client.endpoint_url); !url) {
        return fail(url.error());
    }
    impl_->registrations.push_back(std::make_unique<detail::DiscoveryRegistration>(
        impl_->context.get_executor(), std::move(config), environment));
    return {};
}

void ServerLoop::stop_on_signals(std::function<void()> first)
{
    impl_->signals.add(SIGINT);
    impl_->signals.add(SIGTERM);
    impl_->signals.async_wait([this, first = std::move(first)](std::error_code error, int) {
        if (!error) {
            if (first) {
                busbar::detail::guarded(impl_->log, "what comes before a stop", first);
            }
            impl_->begin_stop();
        }
    });
}

void ServerLoop::on_hangup(std::function<void()> handler)
{
    impl_->on_hangup = std::move(handler);
    impl_->hangup.add(SIGHUP);
    impl_->await_hangup();
}

void ServerLoop::Impl::await_hangup()
{
    if (awaits_hangup || !on_hangup) {
        return;
    }
    hangup.async_wait([this](std::error_code error, int) {
        awaits_hangup = false;
        if (!error) {
            busbar::detail::guarded(log, "on_hangup handler", [this] { on_hangup(); });
            await_hangup();
            after_activity();
        }
    });
    awaits_hangup = true;
}

Configured<void> ServerLoop::Impl::check(const server::Server& next, const Handover& handover) const
{
    if (served.empty() || is_stopping) {
        return misconfigured("loop", "it does not run, or is being stopped",
                             status::Bad_InvalidState);
    }
    if (handover.reason.empty()) {
        return misconfigured("reason", "is empty: clients are to know why");
    }
    if (handover.delay < std::chrono::seconds{0} || handover.delay > longest_delay) {
        return misconfigured("delay", "is not from no time to a day", status::Bad_OutOfRange);
    }
    return check_next(next);
}

Configured<void> ServerLoop::Impl::check_next(const server::Server& next) const
{
    if (std::ranges::any_of(served, [&](const auto& one) { return &one->server() == &next; })) {
        return misconfigured("next", "it is served already");
    }
    // One that was shut down and has no connections has stopped.
    if (next.connection_count() != 0 || next.is_stopped()) {
        return misconfigured("next", "it was used already, and is to be a new one");
    }
    if (!registrations.empty() &&
        next.config().application_uri != served.back()->server().config().application_uri) {
        return misconfigured("application_uri",
                             "is another one than is registered with a discovery server");
    }
    return {};
}

Configured<void> ServerLoop::hand_over(server::Server& next, Handover handover)
{
    if (auto checked = impl_->check(next, handover); !checked) {
        return checked;
    }
    const TimePoint now = detail::now();
    detail::ServedServer& before = *impl_->served.back();
    impl_->serve(next);
    before.released = std::move(handover.released);
    if (handover.return_time == DateTime{}) {
        handover.return_time = SystemWallClock{}.now();
        handover.return_time.ticks += handover.delay.count() * DateTime::ticks_per_second;
    }
    before.server().handle_deadline(now); // it counts the delay from the time that it knows
    server::RunningServer{before.server()}.begin_shutdown(handover.reason, handover.delay,
                                                          handover.return_time);
    impl_->after_activity();
    return {};
}

void ServerLoop::run(server::Server& server)
{
    impl_->serve(server);
    impl_->listeners.start([impl = impl_.get()](tcp::socket socket, std::uint32_t listener) {
        impl->adopt(std::move(socket), detail::ServedServer::Direction::FromClient, listener);
    });
    for (const auto& dialer : impl_->dialers) {
        dialer->start();
    }
    for (const auto& registration : impl_->registrations) {
        registration->start();
    }
    impl_->await_wake();
    impl_->await_deadline();
    impl_->run();
    impl_->for_each([](detail::ServedServer& each) { each.drop_all(); });
    impl_->served.clear();
    impl_->registrations.clear();
}

void ServerLoop::post(std::function<void()> work)
{
    asio::post(impl_->context,
               [this, work = std::move(work)] { impl_->guard("posted work", work); });
}

void ServerLoop::stop()
{
    asio::post(impl_->context, [this] { impl_->begin_stop(); });
}

} // namespace busbar::net
