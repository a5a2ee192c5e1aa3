#include "listener.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <asio/error.hpp>
#include <asio/ip/v6_only.hpp>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::net::detail {

using asio::ip::tcp;

namespace {

constexpr std::chrono::milliseconds first_pause{100};
constexpr std::chrono::milliseconds longest_pause{1'000};
constexpr std::chrono::minutes quiet_time{1};

} // namespace

/// A part of a waiting handler: without memory for a peer's socket Asio destroys the handler
/// instead of calling it.
class Listener::Waiting {
public:
    explicit Waiting(std::shared_ptr<Listener> listener) : listener_{std::move(listener)}
    {
        listener_->is_waiting_ = true;
    }
    Waiting(Waiting&&) noexcept = default;
    Waiting& operator=(Waiting&&) = delete;
    ~Waiting() { static_cast<void>(end()); }

    /// Ends the wait. Returns null if it was not waiting.
    std::shared_ptr<Listener> end()
    {
        if (listener_) {
            listener_->is_waiting_ = false;
        }
        return std::exchange(listener_, nullptr);
    }

private:
    std::shared_ptr<Listener> listener_;
};

Result<std::uint16_t> Listener::reserve(std::string_view address, std::uint16_t port)
{
    place_ = std::string{address} + ":" + std::to_string(port);
    auto error = bind(address, port);
    const auto bound = error ? tcp::endpoint{} : acceptor_.local_endpoint(error);
    if (error) {
        return cannot_listen(error);
    }
    return bound.port();
}

Result<void> Listener::listen()
{
    std::error_code error;
    if (!is_listening_) {
        acceptor_.listen(asio::socket_base::max_listen_connections, error);
    }
    if (error) {
        return cannot_listen(error);
    }
    is_listening_ = true;
    return {};
}

Unexpected<StatusCode> Listener::cannot_listen(std::error_code error) const
{
    busbar::detail::write_safely(*log_, LogLevel::Error, "net",
                                 "cannot listen on " + place_ + ": " + error.message());
    return fail(status::Bad_CommunicationError);
}

std::error_code Listener::bind(std::string_view address, std::uint16_t port)
{
    std::error_code error;
    auto ip = address.empty() ? asio::ip::address{asio::ip::address_v6::any()}
                              : asio::ip::make_address(std::string{address}, error);
    if (error) {
        return error;
    }
    acceptor_.open(ip.is_v6() ? tcp::v6() : tcp::v4(), error);
    if (error && address.empty()) { // a machine without IPv6
        ip = asio::ip::address_v4::any();
        acceptor_.open(tcp::v4(), error);
    }
    if (!error && ip.is_v6()) {
        acceptor_.set_option(asio::ip::v6_only{!address.empty()}, error);
    }
    if (!error) {
        acceptor_.set_option(tcp::acceptor::reuse_address{true}, error);
    }
    if (!error) {
        acceptor_.bind({ip, port}, error);
    }
    return error;
}

void Listener::start(Handler handler)
{
    handler_ = std::move(handler);
    accept();
}

void Listener::close()
{
    handler_ = nullptr;
    pause_.cancel();
    std::error_code ignored;
    acceptor_.close(ignored);
}

void Listener::accept()
{
    if (!handler_ || is_waiting_) {
        return;
    }
    acceptor_.async_accept(
        [waiting = Waiting{shared_from_this()}](std::error_code error, tcp::socket socket) mutable {
            waiting.end()->accepted(error, std::move(socket));
        });
}

void Listener::resume()
{
    accept();
}

void Listener::accepted(std::error_code error, tcp::socket socket)
{
    if (!handler_) {
        return;
    }
    if (error) {
        back_off(error);
        return;
    }
    recover();
    // First, as the handler may throw; or it may close this, which ends the wait.
    accept();
    const Handler handler = handler_;
    busbar::detail::guarded(*log_, "handler of a new connection",
                            [&] { handler(std::move(socket)); });
}

void Listener::back_off(std::error_code error)
{
    if (error != trouble_) {
        trouble_ = error;
        next_pause_ = first_pause;
        tell(error);
    }
    // The peer still waits: asking again at once would only waste time.
    pause_.expires_after(next_pause_);
    next_pause_ = std::min(2 * next_pause_, longest_pause);
    pause_.async_wait([waiting = Waiting{shared_from_this()}](std::error_code cancelled) mutable {
        const auto self = waiting.end();
        if (!cancelled) {
            self->accept();
        }
    });
}

void Listener::tell(std::error_code error)
{
    const auto now = std::chrono::steady_clock::now();
    if (told_at_ && now - *told_at_ < quiet_time) {
        return; // peers could make it come and go
    }
    told_at_ = now;
    is_told_ = true;
    const bool is_descriptors = error == asio::error::no_descriptors;
    busbar::detail::write_safely(
        *log_, LogLevel::Warning, "net",
        "accept: " + error.message() + "; no new connections until that is over. " +
            (is_descriptors ? "Raise the limit of open files (ulimit -n, LimitNOFILE) or "
                              "lower the limit of connections"
                            : "Look at the memory and the network of this machine"));
}

void Listener::recover()
{
    trouble_.clear();
    if (std::exchange(is_told_, false)) {
        busbar::detail::write_safely(*log_, LogLevel::Info, "net",
                                     "accept: there are new connections again");
    }
}

} // namespace busbar::net::detail
