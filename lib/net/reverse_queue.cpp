#include "reverse_queue.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <asio/post.hpp>
#include <asio/read.hpp>
#include <asio/steady_timer.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

#include "channel/frame.hpp"
#include "channel/output_buffer.hpp"
#include "clock.hpp"
#include "keep_alive.hpp"

namespace busbar::net::detail {

using asio::ip::tcp;

namespace {

/// Part 6, 7.1.2.6: two texts of less than 4,096 bytes.
constexpr std::size_t max_hello_size = channel::detail::max_early_size;

bool is_same_url(const std::string& a, const std::string& b)
{
    const auto first = channel::EndpointUrl::parse(a);
    const auto second = channel::EndpointUrl::parse(b);
    return first && second && channel::is_same_host(first->host, second->host) &&
           first->port == second->port && first->path == second->path;
}

} // namespace

bool ExpectedServer::is_met_by(const std::string& uri, const std::string& url) const
{
    return (!server_uri.empty() || !endpoint_url.empty()) &&
           (server_uri.empty() || server_uri == uri) &&
           (endpoint_url.empty() || is_same_url(endpoint_url, url));
}

struct ReverseQueue::Caller {
    explicit Caller(tcp::socket s) : socket{std::move(s)}, timer{socket.get_executor()} {}

    tcp::socket socket;
    asio::steady_timer timer;
    std::vector<std::byte> hello;
    std::string server_uri;
    std::string endpoint_url;
    bool is_held{false}; // its ReverseHello arrived, and no client needs it yet
    bool is_gone{false}; // does not belong to the queue any more
};

ReverseQueue::ReverseQueue(asio::any_io_executor executor, LogSink& log,
                           const ReverseListenerLimits& limits)
    : executor_{std::move(executor)}, log_{&log}, limits_{limits}
{
}

Result<std::uint16_t> ReverseQueue::listen(std::string_view address, std::uint16_t port)
{
    const auto listener = std::make_shared<Listener>(executor_, *log_);
    const auto bound = listener->open(address, port);
    if (bound) {
        listeners_.push_back(listener);
        listener->start([this](tcp::socket socket) { admit(std::move(socket)); });
    }
    return bound;
}

void ReverseQueue::stop()
{
    for (const auto& listener : std::exchange(listeners_, {})) {
        listener->close();
    }
    while (!callers_.empty()) {
        drop(std::shared_ptr{callers_.front()});
    }
}

ReverseQueue::Ticket ReverseQueue::expect(ExpectedServer server)
{
    clients_[next_ticket_] = {std::move(server), nullptr};
    return next_ticket_++;
}

void ReverseQueue::forget(Ticket ticket)
{
    clients_.erase(ticket);
}

void ReverseQueue::take(Ticket ticket, Handler handler)
{
    clients_.at(ticket).handler = std::move(handler);
    asio::post(executor_, [self = shared_from_this(), ticket] { self->serve(ticket); });
}

void ReverseQueue::cancel(Ticket ticket)
{
    clients_.at(ticket).handler = nullptr;
}

void ReverseQueue::admit(tcp::socket socket)
{
    if (callers_.size() >= limits_.max_waiting) {
        drop(std::shared_ptr{callers_.front()});
    }
    const auto caller = std::make_shared<Caller>(std::move(socket));
    callers_.push_back(caller);
    limit(caller, limits_.hello_timeout);
    read_header(caller);
}

void ReverseQueue::limit(const std::shared_ptr<Caller>& caller, Duration time)
{
    caller->timer.expires_after(time);
    caller->timer.async_wait([self = shared_from_this(), caller](std::error_code error) {
        if (!error) {
            self->drop(caller);
        }
    });
}

void ReverseQueue::read_header(const std::shared_ptr<Caller>& caller)
{
    caller->hello.resize(channel::detail::header_size);
    asio::async_read(caller->socket, asio::buffer(caller->hello),
                     [self = shared_from_this(), caller](std::error_code error, std::size_t) {
                         error ? self->drop(caller) : self->read_body(caller);
                     });
}

void ReverseQueue::read_body(const std::shared_ptr<Caller>& caller)
{
    const auto header = channel::detail::parse_frame_header(caller->hello, max_hello_size);
    if (!header || header->type != channel::detail::MessageType::RHE) {
        refuse(caller, header ? status::Bad_TcpMessageTypeInvalid : header.error(),
               "sent no ReverseHello");
        return;
    }
    caller->hello.resize(header->size);
    const auto body = std::span{caller->hello}.subspan(channel::detail::header_size);
    asio::async_read(caller->socket, asio::buffer(body.data(), body.size()),
                     [self = shared_from_this(), caller](std::error_code error, std::size_t) {
                         error ? self->drop(caller) : self->greet(caller);
                     });
}

/// The ReverseHello has arrived.
void ReverseQueue::greet(const std::shared_ptr<Caller>& caller)
{
    if (caller->is_gone) {
        return;
    }
    const auto hello = channel::detail::parse_reverse_hello(
        std::span{caller->hello}.subspan(channel::detail::header_size));
    if (!hello) {
        refuse(caller, hello.error(), "sent a ReverseHello that is none");
        return;
    }
    caller->server_uri = hello->server_uri.str();
    caller->endpoint_url = hello->endpoint_url.str();
    bool is_expected = false;
    for (auto& [ticket, client] : clients_) {
        if (client.server.is_met_by(caller->server_uri, caller->endpoint_url)) {
            is_expected = true;
            if (client.handler) {
                hand_over(caller, client);
                return;
            }
        }
    }
    if (is_expected) {
        hold(caller);
    } else { // Part 6, 7.1.2.6
        refuse(caller, status::Bad_TcpEndpointUrlInvalid,
               "is not expected: " + printable(caller->server_uri) + " at " +
                   printable(caller->endpoint_url));
    }
}

void ReverseQueue::hold(const std::shared_ptr<Caller>& caller)
{
    caller->is_held = true;
    keep_alive(caller->socket);
    limit(caller, limits_.hold_time);
    // A server must be silent before it gets a Hello: anything it sends makes the connection
    // useless.
    caller->socket.async_wait(tcp::socket::wait_read,
                              [self = shared_from_this(), caller](std::error_code error) {
                                  if (!error) {
                                      self->drop(caller);
                                  }
                              });
}

/// A client needs a connection; perhaps its server is waiting already.
void ReverseQueue::serve(Ticket ticket)
{
    const auto client = clients_.find(ticket);
    if (client == clients_.end() || !client->second.handler) {
        return;
    }
    // The newest one, since the server may have left an older one without notice.
    const auto found = std::find_if(callers_.rbegin(), callers_.rend(), [&](const auto& caller) {
        return caller->is_held &&
               client->second.server.is_met_by(caller->server_uri, caller->endpoint_url);
    });
    if (found != callers_.rend()) {
        hand_over(std::shared_ptr{*found}, client->second);
    }
}

void ReverseQueue::hand_over(const std::shared_ptr<Caller>& caller, Client& client)
{
    const Handler handler = std::exchange(client.handler, nullptr);
    caller->is_gone = true;
    callers_.remove(caller);
    std::error_code ignored;
    caller->timer.cancel();
    caller->socket.cancel(ignored);
    handler(std::move(caller->socket), caller->hello);
}

void ReverseQueue::refuse(const std::shared_ptr<Caller>& caller, StatusCode status,
                          const std::string& why)
{
    if (caller->is_gone) {
        return;
    }
    std::error_code error;
    const auto peer = caller->socket.remote_endpoint(error);
    busbar::detail::write_safely(
        *log_, LogLevel::Warning, "net",
        "reverse connection: " + (error ? "a peer" : peer.address().to_string()) + " " + why);
    channel::detail::OutputBuffer output;
    channel::detail::write_error(output, status, {});
    // The socket's buffer is empty and takes it; otherwise the peer does not learn the reason.
    caller->socket.non_blocking(true, error);
    caller->socket.write_some(asio::buffer(output.output().data(), output.output().size()), error);
    drop(caller);
}

void ReverseQueue::drop(const std::shared_ptr<Caller>& caller)
{
    if (std::exchange(caller->is_gone, true)) {
        return;
    }
    callers_.remove(caller);
    std::error_code ignored;
    detail::stop(caller->timer);
    caller->socket.shutdown(tcp::socket::shutdown_both, ignored);
    caller->socket.close(ignored);
}

} // namespace busbar::net::detail

namespace busbar::net {

ReverseListener::ReverseListener(asio::any_io_executor executor, LogSink& log,
                                 ReverseListenerLimits limits)
    : queue_{std::make_shared<detail::ReverseQueue>(std::move(executor), log, limits)}
{
}

ReverseListener::~ReverseListener()
{
    queue_->stop();
}

Result<std::uint16_t> ReverseListener::listen(std::string_view address, std::uint16_t port)
{
    return queue_->listen(address, port);
}

} // namespace busbar::net
