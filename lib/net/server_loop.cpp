#include <busbar/net/server_loop.hpp>

#include <algorithm>
#include <csignal>
#include <functional>
#include <utility>
#include <vector>

#include <asio/post.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/running_server.hpp>

#include "server_loop_impl.hpp"

namespace busbar::net {

namespace {

using asio::ip::tcp;

constexpr std::chrono::hours longest_delay{24};

} // namespace

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

Result<std::uint16_t> ServerLoop::reserve(std::string_view address, std::uint16_t port,
                                          std::uint32_t listener)
{
    return impl_->listeners.reserve(address, port, listener);
}

Result<void> ServerLoop::listen_on_reserved()
{
    return impl_->listeners.listen();
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

void ServerLoop::unregister()
{
    for (const auto& registration : impl_->registrations) {
        registration->stop({});
    }
}

void ServerLoop::register_again()
{
    if (impl_->is_stopping) {
        return;
    }
    for (const auto& registration : impl_->registrations) {
        registration->start_again();
    }
}

void ServerLoop::stop_on_signals(std::function<void()> first)
{
    impl_->signals.emplace(impl_->context, SIGINT, SIGTERM);
    impl_->signals->async_wait([this, first = std::move(first)](std::error_code error, int) {
        if (!error) {
            if (first) {
                busbar::detail::guarded(impl_->log, "handler before a stop", first);
            }
            impl_->begin_stop();
        }
    });
}

void ServerLoop::on_hangup(std::function<void()> handler)
{
    impl_->hangup.emplace(impl_->context, SIGHUP);
    impl_->on_hangup = std::move(handler);
    impl_->await_hangup();
}

Configured<void> ServerLoop::Impl::check(const server::Server& next, const Handover& handover) const
{
    if (served.empty() || is_stopping) {
        return misconfigured("loop", "does not run, or is being stopped", status::Bad_InvalidState);
    }
    if (handover.reason.empty()) {
        return misconfigured("reason", "is empty, but clients must be told a reason");
    }
    if (handover.delay < std::chrono::seconds{0} || handover.delay > longest_delay) {
        return misconfigured("delay", "must be between 0 and 24 hours", status::Bad_OutOfRange);
    }
    return check_next(next);
}

Configured<void> ServerLoop::Impl::check_next(const server::Server& next) const
{
    if (std::ranges::any_of(served, [&](const auto& one) { return &one->server() == &next; })) {
        return misconfigured("next", "is served already");
    }
    // A server that was shut down and has no connections has stopped.
    if (next.connection_count() != 0 || next.is_stopped()) {
        return misconfigured("next", "was used already, expected a new server");
    }
    if (!registrations.empty() &&
        next.config().application_uri != served.back()->server().config().application_uri) {
        return misconfigured("application_uri",
                             "differs from the one that is registered with a discovery server");
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
    before.server().handle_deadline(now); // it counts the delay from its latest time
    server::RunningServer{before.server()}.begin_shutdown(handover.reason, handover.delay,
                                                          handover.return_time);
    impl_->after_activity();
    return {};
}

void ServerLoop::Impl::begin(server::Server& server)
{
    serve(server);
    listeners.start([this](tcp::socket socket, std::uint32_t listener) {
        adopt(std::move(socket), detail::ServedServer::Direction::FromClient, listener);
    });
    for (const auto& dialer : dialers) {
        dialer->start();
    }
    for (const auto& registration : registrations) {
        registration->start();
    }
    await_wake();
    await_deadline();
}

void ServerLoop::Impl::end()
{
    for_each([](detail::ServedServer& each) { each.drop_all(); });
    served.clear();
    registrations.clear();
}

void ServerLoop::run(server::Server& server)
{
    impl_->begin(server);
    impl_->run(no_deadline);
    impl_->end();
}

bool ServerLoop::run_for(server::Server& server, Duration time)
{
    if (impl_->context.stopped()) {
        return false;
    }
    if (impl_->served.empty()) {
        busbar::detail::Undo undo{[this] { end_at_once(); }};
        impl_->begin(server);
        undo.keep();
    } else {
        // What the program did meanwhile.
        const StatusCode thrown = busbar::detail::guarded(impl_->log, "network handler",
                                                          [this] { impl_->after_activity(); });
        impl_->is_behind = impl_->is_behind || thrown.is_bad();
    }
    impl_->run(detail::after(time));
    if (impl_->context.stopped()) {
        impl_->end();
    }
    return !impl_->context.stopped();
}

void ServerLoop::end_at_once()
{
    impl_->listeners.close();
    impl_->end();
    impl_->context.stop();
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
