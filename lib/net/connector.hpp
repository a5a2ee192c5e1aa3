#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/expected.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/status_code.hpp>

#include "name_lookup.hpp"

namespace busbar::net::detail {

/// The reason why a host was not reached.
struct Unreached {
    StatusCode status;
    /// "Connection refused".
    std::string reason;
};

/// Connects to a host by the first of its addresses that answers: the next one is tried when one
/// was refused, or did not answer for a quarter of a second, as in RFC 8305. All calls are made on
/// the executor and never block.
class Connector {
public:
    using Handler = std::function<void(Expected<asio::ip::tcp::socket, Unreached>)>;

    /// `log` must outlive the object.
    Connector(asio::any_io_executor executor, LogSink& log, Lookup lookup = system_lookup);
    Connector(const Connector&) = delete;
    Connector& operator=(const Connector&) = delete;
    ~Connector();

    /// Calls `handler` once, later, unless cancelled or started again: Bad_Timeout, or
    /// Bad_CommunicationError. The reason is in the log, too.
    void start(const channel::EndpointUrl& url, Duration timeout, Handler handler);
    void cancel();

private:
    struct Attempt;

    asio::any_io_executor executor_;
    LogSink* log_;
    NameLookup names_;
    std::shared_ptr<Attempt> attempt_;
};

} // namespace busbar::net::detail
