#include <busbar/net/server_loop.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/post.hpp>
#include <asio/signal_set.hpp>
#include <fcntl.h>
#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "discovery_registration.hpp"
#include "link.hpp"
#include "listener.hpp"
#include "reverse_dialer.hpp"
#include "turn_away.hpp"

namespace busbar::net {

namespace {

using asio::ip::tcp;

/// Peers that are being told that there is no place for them.
constexpr std::size_t most_turned_away = 16;

/// Else a link would read on from a peer whose requests wait for their turn.
static_assert(requires(const server::Connection& connection) { connection.has_enough(); });

/// A pipe to oneself: writing one byte neither blocks nor allocates.
class PipeWaker final : public server::Waker {
public:
    explicit PipeWaker(asio::io_context& context) : reader_{context}
    {
        int ends[2] = {-1, -1};
        if (::pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0) {
            reader_.assign(ends[0]);
            writer_ = ends[1];
        }
    }
    ~PipeWaker() override
    {
        if (writer_ >= 0) {
            ::close(writer_);
        }
    }
    void wake() override
    {
        if (!is_awake_.exchange(true)) {
            const char byte = 0;
            static_cast<void>(!::write(writer_, &byte, 1));
        }
    }
    /// Calls `on_wake` on the loop's thread each time. Nothing happens if that is so already.
    template <typename OnWake>
    void wait(OnWake on_wake)
    {
        if (is_waiting_) {
            return;
        }
        reader_.async_read_some(asio::buffer(buffer_),
                                [this, on_wake](std::error_code error, std::size_t) {
                                    is_waiting_ = false;
                                    if (!error) {
                                        is_awake_ = false;
                                        wait(on_wake);
                                        on_wake();
                                    }
                                });
        is_waiting_ = true;
    }

private:
    asio::posix::stream_descriptor reader_;
    int writer_{-1};
    std::atomic<bool> is_awake_{false};
    bool is_waiting_{false};
    char buffer_[64]{};
};

} // namespace

struct ServerLoop::Impl {
    using ConnectionLink = detail::SocketLink<server::Connection>;
    struct Client {
        std::unique_ptr<server::Connection> connection;
        std::shared_ptr<ConnectionLink> link;
    };

    explicit Impl(LogSink& l)
        : log{l}, waker{context}, timer{context.get_executor()}, signals{context}, hangup{context}
    {
    }

    enum class Direction : std::uint8_t { FromClient, ToClient };
    std::optional<std::uint64_t> adopt(tcp::socket socket, Direction direction);
    /// Calls `work`, which may throw, and looks after what it gave others to do.
    template <typename Work>
    void guard(std::string_view name, Work work)
    {
        busbar::detail::guarded(log, name, work);
        after_activity();
    }
    void drain(server::Connection& connection);
    void drop(std::uint64_t id);
    void after_activity();
    void await_deadline();
    void begin_stop();
    void resume();
    void await_wake();
    void await_hangup();
    [[nodiscard]] bool has_stopped() const;

    busbar::detail::SafeLog log;
    asio::io_context context;
    PipeWaker waker;
    detail::DeadlineTimer timer;
    asio::signal_set signals;
    asio::signal_set hangup;
    std::function<void()> on_hangup;
    detail::TurnAway turn_away{most_turned_away};
    std::vector<std::shared_ptr<detail::Listener>> listeners;
    ReverseConnectConfig reverse_connect;
    std::vector<std::unique_ptr<detail::ReverseDialer>> dialers;
    std::vector<std::unique_ptr<detail::DiscoveryRegistration>> registrations;
    std::unordered_map<std::uint64_t, Client> clients;
    server::Server* server{nullptr};
    bool is_stopping{false};
};

/// The connection's id, unless it is refused or gone already.
std::optional<std::uint64_t> ServerLoop::Impl::adopt(tcp::socket socket, Direction direction)
{
    std::error_code error;
    const auto peer = socket.remote_endpoint(error);
    if (error) {
        return std::nullopt;
    }
    auto connection = server->connect(peer.address().to_string(), detail::now());
    if (!connection) {
        // The log has said why.
        if (direction == Direction::FromClient) {
            turn_away(std::move(socket), connection.error(), "no place for a connection");
        }
        return std::nullopt;
    }
    auto owned = std::make_unique<server::Connection>(*std::move(connection));
    if (direction == Direction::ToClient && !owned->reverse_hello(server->config().endpoint_url)) {
        return std::nullopt;
    }
    const std::uint64_t id = owned->id();
    auto link = std::make_shared<ConnectionLink>(
        std::move(socket), *owned,
        [this](ConnectionLink& changed) {
            drain(changed.engine());
            after_activity();
        },
        [this, id](ConnectionLink&) { asio::post(context, [this, id] { drop(id); }); });
    clients.emplace(id, Client{std::move(owned), link});
    link->start();
    after_activity();
    return id;
}

/// The server itself logs what became of a connection.
void ServerLoop::Impl::drain(server::Connection& connection)
{
    while (const auto event = connection.next_event()) {
        if (event->kind == server::ConnectionEvent::Kind::Opened) {
            for (const auto& dialer : dialers) {
                dialer->opened(connection.id());
            }
        }
    }
}

void ServerLoop::Impl::drop(std::uint64_t id)
{
    clients.erase(id);
    for (const auto& dialer : dialers) {
        dialer->ended(id);
    }
    after_activity();
}

/// What one connection did may have given others something to send.
void ServerLoop::Impl::after_activity()
{
    while (const auto id = server->next_changed()) {
        const auto found = clients.find(*id);
        if (found != clients.end()) {
            const auto link = found->second.link;
            link->pump();
        }
    }
    if (has_stopped()) {
        context.stop();
        return;
    }
    await_deadline();
}

/// After an exception that may have kept anything from waiting for what comes next.
void ServerLoop::Impl::resume()
{
    busbar::detail::guarded(log, "resuming", [this] {
        asio::post(context, [this] { after_activity(); });
        for (const auto& listener : listeners) {
            listener->resume();
        }
        await_wake();
    });
}

void ServerLoop::Impl::await_wake()
{
    waker.wait([this] {
        guard("Server::handle_completions", [this] { server->handle_completions(detail::now()); });
    });
}

bool ServerLoop::Impl::has_stopped() const
{
    return is_stopping && server->is_stopped() && clients.empty() &&
           std::ranges::all_of(registrations, [](const auto& one) { return one->is_stopped(); });
}

void ServerLoop::Impl::await_deadline()
{
    timer.await(server->next_deadline(), [this] {
        guard("Server::handle_deadline", [this] { server->handle_deadline(detail::now()); });
    });
}

void ServerLoop::Impl::begin_stop()
{
    if (std::exchange(is_stopping, true)) {
        return;
    }
    for (const auto& listener : listeners) {
        listener->close();
    }
    for (const auto& dialer : dialers) {
        dialer->stop();
    }
    for (const auto& registration : registrations) {
        registration->stop([this] { after_activity(); });
    }
    server->begin_shutdown(detail::now(), "the server is being stopped");
    after_activity();
}

ServerLoop::ServerLoop(LogSink& log) : impl_{std::make_unique<Impl>(log)} {}
ServerLoop::~ServerLoop() = default;

server::Waker& ServerLoop::waker()
{
    return impl_->waker;
}

Result<std::uint16_t> ServerLoop::listen(std::string_view address, std::uint16_t port)
{
    const auto listener =
        std::make_shared<detail::Listener>(impl_->context.get_executor(), impl_->log);
    const auto bound = listener->open(address, port);
    if (bound) {
        impl_->listeners.push_back(listener);
    }
    return bound;
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
                return impl->adopt(std::move(socket), Impl::Direction::ToClient);
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

void ServerLoop::stop_on_signals()
{
    impl_->signals.add(SIGINT);
    impl_->signals.add(SIGTERM);
    impl_->signals.async_wait([this](std::error_code error, int) {
        if (!error) {
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
    hangup.async_wait([this](std::error_code error, int) {
        if (!error) {
            await_hangup();
            guard("on_hangup handler", [this] { on_hangup(); });
        }
    });
}

void ServerLoop::run(server::Server& server)
{
    impl_->server = &server;
    server.start(detail::now());
    for (const auto& listener : impl_->listeners) {
        listener->start([impl = impl_.get()](tcp::socket socket) {
            impl->adopt(std::move(socket), Impl::Direction::FromClient);
        });
    }
    for (const auto& dialer : impl_->dialers) {
        dialer->start();
    }
    for (const auto& registration : impl_->registrations) {
        registration->start();
    }
    impl_->await_wake();
    impl_->await_deadline();
    while (!impl_->context.stopped()) {
        const StatusCode thrown = busbar::detail::guarded(impl_->log, "what the network called",
                                                          [this] { impl_->context.run(); });
        if (thrown.is_bad()) {
            impl_->resume();
        }
    }
    impl_->clients.clear();
    impl_->registrations.clear();
}

void ServerLoop::stop()
{
    asio::post(impl_->context, [this] { impl_->begin_stop(); });
}

} // namespace busbar::net
