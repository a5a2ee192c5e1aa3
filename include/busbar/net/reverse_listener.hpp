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
/// A server is admitted if a client expects it: its ReverseHello must name ClientConfig::server_uri
/// and ClientConfig::endpoint_url; an empty one is not compared, but one of them must be set. A
/// server that no client expects is answered with Bad_TcpEndpointUrlInvalid. A ReverseHello proves
/// nothing: the client trusts the server's certificate only. All calls are made on the executor.
class BUSBAR_API ReverseListener {
public:
    /// `log` must outlive the object and the clients that use it.
    ReverseListener(asio::any_io_executor executor, LogSink& log,
                    ReverseListenerLimits limits = {});
    ReverseListener(const ReverseListener&) = delete;
    ReverseListener& operator=(const ReverseListener&) = delete;
    /// Closes connections that wait. Clients that still need one do not get one any more.
    ~ReverseListener();

    /// Listens on `address` ("" means every address of the machine, IPv4 and IPv6) and `port` (0
    /// means any free one). Returns the port, or Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port);

private:
    friend class AsyncClient;
    friend class BlockingClient;

    std::shared_ptr<detail::ReverseQueue> queue_;
};

} // namespace busbar::net
