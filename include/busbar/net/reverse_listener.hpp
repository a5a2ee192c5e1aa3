#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include <asio/any_io_executor.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/net/reverse_limits.hpp>

namespace busbar::net {

namespace detail {
class ReverseQueue;
} // namespace detail

/// A port at which servers report to clients that cannot reach them (Part 6, 7.1.2.6), for any
/// number of AsyncClients.
///
/// A server is let in if a client expects it: its ReverseHello must name ClientConfig::server_uri
/// and ClientConfig::endpoint_url; an empty one is not compared, but one of them must be given. A
/// server that nobody expects is answered with Bad_TcpEndpointUrlInvalid. A ReverseHello proves
/// nothing: what the client trusts is the server's certificate. All calls on the executor.
class BUSBAR_API ReverseListener {
public:
    /// `log` must outlive the object and the clients that use it.
    ReverseListener(asio::any_io_executor executor, LogSink& log,
                    ReverseListenerLimits limits = {});
    ReverseListener(const ReverseListener&) = delete;
    ReverseListener& operator=(const ReverseListener&) = delete;
    /// Closes connections that wait. Clients that still want one do not get one any more.
    ~ReverseListener();

    /// Listens on `address` ("" is every address of the machine, IPv4 and IPv6) and `port` (0 is
    /// any that is free). Gives the port, or Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port);

private:
    friend class AsyncClient;
    friend class BlockingClient;

    std::shared_ptr<detail::ReverseQueue> queue_;
};

} // namespace busbar::net
