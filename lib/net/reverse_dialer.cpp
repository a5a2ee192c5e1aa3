#include "reverse_dialer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <asio/socket_base.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::net::detail {

namespace {

/// A client that kept a connection for so long did not refuse it; it only had no use for it.
constexpr Duration long_enough = std::chrono::seconds{2};

/// Nothing may be said on the connection for days; TCP is to notice all the same that it is dead:
/// after a minute of silence, and six questions that nobody answers. Where that fails, the system's
/// own times hold.
void keep_alive(asio::ip::tcp::socket& socket)
{
    std::error_code ignored;
    socket.set_option(asio::socket_base::keep_alive{true}, ignored);
#if defined(TCP_KEEPIDLE) && defined(TCP_KEEPINTVL) && defined(TCP_KEEPCNT)
    const auto set = [&](int option, int value) {
        static_cast<void>(
            ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value));
    };
    set(TCP_KEEPIDLE, 60);
    set(TCP_KEEPINTVL, 10);
    set(TCP_KEEPCNT, 6);
#endif
}

} // namespace

ReverseDialer::ReverseDialer(const asio::any_io_executor& executor, LogSink& log,
                             channel::EndpointUrl url, const ReverseConnectConfig& config,
                             Adopt adopt)
    : log_{&log}, url_{std::move(url)}, config_{&config}, adopt_{std::move(adopt)},
      connector_{executor, log}, timer_{executor}, delay_{config.first_delay}
{
}

void ReverseDialer::start()
{
    dial();
}

void ReverseDialer::stop()
{
    has_stopped_ = true;
    connector_.cancel();
    timer_.cancel();
}

void ReverseDialer::opened(std::uint64_t connection)
{
    if (spare_ == connection) {
        spare_.reset();
        used_.insert(connection);
        delay_ = config_->first_delay;
        dial();
    }
}

void ReverseDialer::ended(std::uint64_t connection)
{
    if (spare_ == connection) {
        spare_.reset();
        if (now() - spare_since_ >= long_enough) {
            delay_ = config_->first_delay;
        }
        dial_later();
    } else if (used_.erase(connection) != 0) {
        dial();
    }
}

void ReverseDialer::dial()
{
    if (has_stopped_ || is_dialing_ || spare_ || used_.size() >= config_->max_connections) {
        return;
    }
    is_dialing_ = true;
    connector_.start(url_, config_->connect_timeout, [this](Result<asio::ip::tcp::socket> socket) {
        connected(std::move(socket));
    });
}

void ReverseDialer::connected(Result<asio::ip::tcp::socket> socket)
{
    is_dialing_ = false;
    spare_since_ = now();
    std::optional<std::uint64_t> id;
    if (socket) {
        keep_alive(*socket);
        busbar::detail::guarded(*log_, "a connection to a client",
                                [&] { id = adopt_(*std::move(socket)); });
    }
    if (id) {
        spare_ = id;
    } else {
        dial_later();
    }
}

void ReverseDialer::dial_later()
{
    if (has_stopped_ || is_dialing_) {
        return;
    }
    is_dialing_ = true;
    const double part = std::uniform_real_distribution<double>{0.8, 1.0}(random_);
    const auto wait = std::chrono::duration_cast<Duration>(delay_ * part);
    delay_ = std::min(delay_ * 2, config_->longest_delay);
    timer_.await(after(wait), [this] {
        is_dialing_ = false;
        dial();
    });
}

} // namespace busbar::net::detail
