#pragma once

#include <string>
#include <utility>

#include <busbar/net/client_loop.hpp>
#include <busbar/net/system.hpp>

#include "context.hpp"
#include "verbose_log.hpp"

namespace busbar::cli {

/// A channel without security and without session, for what every server tells strangers (Part 4,
/// 5.5).
class DiscoveryConnection {
public:
    /// Connects; throws Failure.
    explicit DiscoveryConnection(Context& context);
    DiscoveryConnection(const DiscoveryConnection&) = delete;
    DiscoveryConnection& operator=(const DiscoveryConnection&) = delete;
    ~DiscoveryConnection() { loop_.close(); }

    /// Throws Failure.
    template <typename Response, typename Request>
    [[nodiscard]] Response call(Request request)
    {
        const auto event = loop_.call(std::move(request));
        const auto response = event ? event->template response<Response>() : fail(event.error());
        if (!response) {
            throw Failure{response.error(), url_};
        }
        return *response; // a copy owns its strings
    }

private:
    std::string url_;
    VerboseLog log_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    channel::ChannelEnvironment environment_;
    net::ClientLoop loop_;
};

} // namespace busbar::cli
