#include "connector.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "clock.hpp"

namespace busbar::net::detail {

using asio::ip::tcp;

namespace {

/// More than any sensible host has.
constexpr std::size_t max_addresses = 16;
/// RFC 8305, section 5: Connection Attempt Delay.
constexpr Duration patience = std::chrono::milliseconds{250};

/// A client on the machine of a missing server may get the server's port as its own and so, by
/// TCP's simultaneous open, be connected to itself.
bool is_own_echo(const tcp::socket& socket)
{
    std::error_code error;
    const auto local = socket.local_endpoint(error);
    return !error && local == socket.remote_endpoint(error);
}

} // namespace

/// One call of start(). Handlers keep it alive; once ended it does nothing any more.
struct Connector::Attempt : std::enable_shared_from_this<Attempt> {
    Attempt(const asio::any_io_executor& e, LogSink& l, channel::EndpointUrl u, Handler h)
        : executor{e}, log{&l}, url{std::move(u)}, handler{std::move(h)}, timeout{e}, stagger{e}
    {
    }

    void limit(Duration time);
    void found(std::vector<asio::ip::address> all);
    void try_next();
    void tried(const std::shared_ptr<tcp::socket>& socket, std::error_code error);
    void fail_with(StatusCode status, const std::string& why);
    void end();

    asio::any_io_executor executor;
    LogSink* log;
    channel::EndpointUrl url;
    Handler handler; // null once ended
    asio::steady_timer timeout;
    asio::steady_timer stagger;
    std::vector<asio::ip::address> addresses;
    std::size_t next{0};
    std::vector<std::shared_ptr<tcp::socket>> sockets; // those that are being connected
};

void Connector::Attempt::limit(Duration time)
{
    const TimePoint deadline = after(time);
    if (deadline == no_deadline) {
        return;
    }
    timeout.expires_at(deadline);
    timeout.async_wait([self = shared_from_this()](std::error_code error) {
        if (!error) {
            self->fail_with(status::Bad_Timeout, "no answer in time");
        }
    });
}

void Connector::Attempt::found(std::vector<asio::ip::address> all)
{
    addresses = std::move(all);
    addresses.resize(std::min(addresses.size(), max_addresses));
    if (addresses.empty()) {
        fail_with(status::Bad_CommunicationError, "the host has no address");
    } else {
        try_next();
    }
}

void Connector::Attempt::try_next()
{
    if (!handler || next == addresses.size()) {
        return;
    }
    const tcp::endpoint endpoint{addresses[next++], url.port};
    const auto socket = std::make_shared<tcp::socket>(executor);
    sockets.push_back(socket);
    socket->async_connect(endpoint, [self = shared_from_this(), socket](std::error_code error) {
        self->tried(socket, error);
    });
    stagger.expires_after(patience);
    stagger.async_wait([self = shared_from_this()](std::error_code error) {
        if (!error) {
            self->try_next();
        }
    });
}

void Connector::Attempt::tried(const std::shared_ptr<tcp::socket>& socket, std::error_code error)
{
    if (!handler) {
        return;
    }
    std::erase(sockets, socket);
    if (!error && is_own_echo(*socket)) {
        // A reset, so that the port is free at once for its server.
        std::error_code ignored;
        socket->set_option(asio::socket_base::linger{true, 0}, ignored);
        socket->close(ignored);
        error = asio::error::connection_refused;
    }
    if (!error) {
        const Handler done = std::exchange(handler, nullptr);
        end();
        done(std::move(*socket));
    } else if (next < addresses.size()) {
        try_next();
    } else if (sockets.empty()) {
        fail_with(status::Bad_CommunicationError, error.message());
    }
}

void Connector::Attempt::fail_with(StatusCode status, const std::string& why)
{
    if (const Handler done = std::exchange(handler, nullptr)) {
        busbar::detail::write_safely(*log, LogLevel::Info, "net",
                                     "cannot connect to " + url.text() + ": " + why);
        end();
        done(Unexpected{Unreached{status, why}});
    }
}

void Connector::Attempt::end()
{
    handler = nullptr;
    stop(timeout);
    stop(stagger);
    for (const auto& socket : std::exchange(sockets, {})) {
        std::error_code ignored;
        socket->close(ignored);
    }
}

Connector::Connector(asio::any_io_executor executor, LogSink& log, Lookup lookup)
    : executor_{executor}, log_{&log}, names_{std::move(executor), std::move(lookup)}
{
}

Connector::~Connector()
{
    cancel();
}

void Connector::start(const channel::EndpointUrl& url, Duration timeout, Handler handler)
{
    cancel();
    attempt_ = std::make_shared<Attempt>(executor_, *log_, url, std::move(handler));
    attempt_->limit(timeout);
    names_.start(url.host, [attempt = attempt_](std::vector<asio::ip::address> addresses) {
        attempt->found(std::move(addresses));
    });
}

void Connector::cancel()
{
    names_.cancel();
    if (const auto attempt = std::exchange(attempt_, nullptr)) {
        attempt->end();
    }
}

} // namespace busbar::net::detail
