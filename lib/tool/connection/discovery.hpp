#pragma once

#include <string>
#include <utility>

#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>

#include "context.hpp"
#include "logs.hpp"

namespace busbar::tool {

/// A channel without security and without session, for what every server tells strangers (Part 4,
/// 5.5).
class DiscoveryConnection {
public:
    /// Connects; throws Failure.
    explicit DiscoveryConnection(Context& context);
    DiscoveryConnection(const DiscoveryConnection&) = delete;
    DiscoveryConnection& operator=(const DiscoveryConnection&) = delete;
    ~DiscoveryConnection() { client_.close(); }

    [[nodiscard]] const std::string& url() const { return url_; }
    /// Throws Failure.
    template <typename Response, typename Request>
    [[nodiscard]] Response call(Request request)
    {
        auto response = client_.call<Response>(std::move(request));
        if (!response) {
            throw Failure{response.error(), url_};
        }
        return *std::move(response);
    }

private:
    std::string url_;
    VerboseLog log_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    channel::ChannelEnvironment environment_;
    net::BlockingClient client_;
};

} // namespace busbar::tool
