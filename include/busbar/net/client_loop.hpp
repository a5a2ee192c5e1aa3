#pragma once

#include <memory>
#include <optional>
#include <utility>

#include <busbar/client/connection.hpp>
#include <busbar/core/api.hpp>
#include <busbar/net/system.hpp>

namespace busbar::net {

/// One client connection over TCP, driven by the code that waits for its events: for programs that
/// do one thing after the other. One thread. Creating one sets M_TRIM_THRESHOLD and
/// M_MMAP_THRESHOLD of glibc's malloc, as a BlockingClient does.
class BUSBAR_API ClientLoop {
public:
    ClientLoop();
    ClientLoop(const ClientLoop&) = delete;
    ClientLoop& operator=(const ClientLoop&) = delete;
    ~ClientLoop();

    /// Connects to the configuration's endpoint URL and begins the handshake. Blocks until there is
    /// a connection, at most `timeout`. Bad_Timeout, Bad_CommunicationError or
    /// Bad_TcpEndpointUrlInvalid. `environment` must outlive the loop.
    [[nodiscard]] Result<void> connect(client::ConnectionConfig config,
                                       const channel::ChannelEnvironment& environment,
                                       Duration timeout = std::chrono::seconds{10});
    /// The client; only after connect().
    [[nodiscard]] client::Connection& client();
    /// Waits for the next event; nothing after `timeout`.
    [[nodiscard]] std::optional<client::ConnectionEvent>
    wait(Duration timeout = std::chrono::seconds{30});
    /// Sends `request` and waits for its response; other events are dropped.
    template <typename Request>
    [[nodiscard]] Result<client::ConnectionEvent> call(Request&& request)
    {
        const auto handle = client().send(std::forward<Request>(request));
        if (!handle) {
            return fail(handle.error());
        }
        return wait_for(*handle);
    }
    /// Waits until the session is open; the status is the reason of a failure.
    [[nodiscard]] Result<void> wait_until_ready();
    /// Closes session and connection, and waits until that is sent.
    void close();

private:
    [[nodiscard]] Result<client::ConnectionEvent> wait_for(std::uint32_t handle);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
