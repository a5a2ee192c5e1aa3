#include "reverse_dialer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "keep_alive.hpp"

namespace busbar::net::detail {

namespace {

/// A client that kept a connection for so long did not refuse it; it only had no use for it.
constexpr Duration long_enough = std::chrono::seconds{2};

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
    connector_.start(url_, config_->connect_timeout,
                     [this](Expected<asio::ip::tcp::socket, Unreached> socket) {
                         connected(std::move(socket));
                     });
}

void ReverseDialer::connected(Expected<asio::ip::tcp::socket, Unreached> socket)
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
