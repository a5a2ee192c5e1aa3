#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/client/response.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::client {

/// Limits of one request; 0: as much as fits (Part 5, 6.3.11). A service with more work sends
/// several requests.
struct ServerOperationLimits {
    std::uint32_t max_nodes_per_read{0};
    std::uint32_t max_nodes_per_write{0};
    std::uint32_t max_nodes_per_method_call{0};
    std::uint32_t max_nodes_per_browse{0};
    std::uint32_t max_nodes_per_register_nodes{0};
    std::uint32_t max_nodes_per_translate_browse_paths{0};
    std::uint32_t max_nodes_per_node_management{0};
    std::uint32_t max_monitored_items_per_call{0};

    friend bool operator==(const ServerOperationLimits&, const ServerOperationLimits&) = default;
};

/// The client's knowledge of the session's server; read again with every new session.
struct ServerInfo {
    /// Server_NamespaceArray and Server_ServerArray (Part 5, 6.3.1). They own their strings.
    std::vector<std::string> namespaces;
    std::vector<std::string> servers;
    ServerOperationLimits operation_limits;
    /// Grows by one whenever something above has changed.
    std::uint64_t revision{0};

    /// The last state that was read, which happens when the server has been silent.
    ServerState state{ServerState::Running};
    std::uint32_t seconds_till_shutdown{0};
};

/// Identifies a request of a Requester; unique while it lives.
using RequestId = std::uint64_t;

/// The timeout of a request, and its diagnostics.
struct RequestOptions {
    /// The request ends with Bad_Timeout after this time; zero: as the client is configured.
    Duration timeout{0};
    /// Without a session the request waits for one, at most for its timeout; if false, it ends at
    /// once with Bad_ServerNotConnected.
    bool waits_for_session{true};
    /// RequestHeader.returnDiagnostics (Part 4, 7.32).
    std::uint32_t return_diagnostics{0};
};

/// The body of a response: NodeId of the encoding and the structure.
struct ResponseBody {
    std::vector<std::byte> bytes;

    /// Decodes a T that owns its strings; Bad_DecodingError if it is another type, Bad_OutOfMemory.
    template <typename T>
    [[nodiscard]] Result<T> decoded(const binary::DecodeLimits& limits,
                                    const binary::TypeRegistry& types = standard_types()) const
    {
        Result<T> response = fail(status::Bad_OutOfMemory);
        busbar::detail::attempt(
            [&] { response = decode_response<T>(bytes, binary::Strings::Own, limits, types); });
        return response;
    }
};

/// Sends requests within a session and passes their responses on. Everything above a connection is
/// written against it, so that a test can replace the Client. One thread.
class BUSBAR_API Requester {
public:
    /// Called once for each request, never from within call(), and not after cancel(). It may make
    /// requests and cancel others; what it throws is logged. It gets the response, the
    /// ServiceResult if that is bad, or the reason why there is no response: Bad_Timeout,
    /// Bad_ConnectionClosed, Bad_ServerNotConnected, Bad_EncodingLimitsExceeded,
    /// Bad_TooManyOperations, Bad_OutOfMemory.
    template <typename Response>
    using Handler = std::function<void(Result<Response>)>;

    Requester() = default;
    Requester(const Requester&) = delete;
    Requester& operator=(const Requester&) = delete;
    virtual ~Requester() = default;

    /// Sends `request`, whose header is filled in when it goes out. `Response` is the type of its
    /// response.
    template <typename Response, typename Request>
    RequestId call(Request request, Handler<Response> handler, RequestOptions options = {})
    {
        return start(
            [request = std::move(request), bits = options.return_diagnostics](
                binary::Writer& writer, const RequestHeader& header) mutable {
                request.request_header = header;
                request.request_header.return_diagnostics = bits;
                encode(writer, NodeId{0, Request::binary_encoding_id});
                encode(writer, request);
            },
            [this, handler = std::move(handler)](Result<ResponseBody> body) {
                handler(body ? body->template decoded<Response>(decode_limits(), types())
                             : fail(body.error()));
            },
            options);
    }
    /// Forgets the request: its handler is not called, and a late response is dropped.
    virtual void cancel(RequestId id) = 0;

    /// The limits and names that the server has told.
    [[nodiscard]] virtual const ServerInfo& server() const = 0;
    /// The time of the present call.
    [[nodiscard]] virtual TimePoint now() const = 0;
    /// The limits that responses are decoded with.
    [[nodiscard]] virtual const binary::DecodeLimits& decode_limits() const = 0;
    /// The structures that responses are decoded with: at least those of namespace 0.
    [[nodiscard]] virtual const binary::TypeRegistry& types() const { return standard_types(); }
    /// Receives exceptions of handlers; may be null.
    [[nodiscard]] virtual LogSink* log() const { return nullptr; }

protected:
    /// Writes the request with the given header; may be called later.
    using Encode = std::function<void(binary::Writer&, const RequestHeader&)>;

    /// Sends a request; the handler gets the response, or the reason why there is none.
    virtual RequestId start(Encode encode, Handler<ResponseBody> handler,
                            const RequestOptions& options) = 0;
};

} // namespace busbar::client
