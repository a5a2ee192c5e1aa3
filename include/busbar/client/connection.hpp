#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/client/response.hpp>
#include <busbar/client/response_limits.hpp>
#include <busbar/client/user_identity.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::client {

/// A session in the form in which another connection can resume it (Part 4, 5.7.3).
struct SessionTicket {
    NodeId session_id;
    NodeId authentication_token;
    /// The last nonce, which the next proofs are made with.
    ByteString server_nonce;
    /// RevisedSessionTimeout, held within sensible bounds whatever the server said.
    std::chrono::milliseconds timeout{0};
};

/// The configuration of a connection and its session.
struct ConnectionConfig {
    channel::ClientChannelConfig channel;
    std::string application_name{"Busbar client"};
    std::string application_uri{"urn:busbar:client"};
    std::string session_name{"Busbar"};
    UserIdentity identity;
    /// The token policy that the identity is sent with; if none, the best one in CreateSession's
    /// endpoints.
    std::optional<UserTokenPolicy> token_policy;
    /// The result of GetEndpoints, which CreateSession must repeat; if null, nothing is compared.
    Array<EndpointDescription> discovered_endpoints;
    /// A session of an earlier connection: it is activated again and, if the server refuses that,
    /// another one is created.
    std::optional<SessionTicket> resumed_session;
    std::chrono::milliseconds session_timeout{60'000};
    /// LocaleIds of the session's texts in order of preference (Part 4, 5.4).
    std::vector<std::string> locale_ids;
    /// An open request ends with Bad_Timeout after this time, unless it has a timeout of its own.
    std::chrono::milliseconds request_timeout{10'000};
    /// False for FindServers and GetEndpoints, which need no session.
    bool wants_session{true};
    /// Limits of responses.
    binary::DecodeLimits limits{response_limits};
};

/// An occurrence on a client's connection.
struct ConnectionEvent {
    /// The kind of occurrence.
    enum class Kind : std::uint8_t {
        Ready,    // the session is activated, or the channel open if no session is wanted
        Response, // to the request with `handle`
        Closed,   // the last event
    };
    Kind kind{Kind::Closed};
    std::uint32_t handle{0};
    /// Response: the ServiceResult, or Bad_Timeout, Bad_SecureChannelClosed if none came. Closed:
    /// the reason.
    StatusCode status;
    /// Response: NodeId of the encoding and the structure; empty if none came.
    std::vector<std::byte> body;
    /// Response: the context that send_encoded() was given with the request.
    std::uint64_t context{0};

    /// Returns the response as a T, whose strings borrow from this event. Bad_DecodingError if it
    /// is another type, the ServiceResult if that is bad. `types` has the structures of namespace 0
    /// and others, by the server's namespace indices.
    template <typename T>
    [[nodiscard]] Result<T> response(const binary::DecodeLimits& limits = response_limits,
                                     const binary::TypeRegistry& types = standard_types()) const;
};

/// A client on one connection to a server: opens the channel, creates and activates a session,
/// sends requests and matches their responses. Sans-I/O, in the shape of the channel. It ends when
/// the connection is lost; Client creates new ones.
class BUSBAR_API Connection {
public:
    /// `environment` must outlive the Connection.
    Connection(ConnectionConfig config, const channel::ChannelEnvironment& environment,
               TimePoint now);
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;
    ~Connection();

    /// Takes bytes of the server; an error ends the connection.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::optional<ConnectionEvent> next_event();
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    /// The time at which handle_deadline() has something to do; no_deadline if it has nothing.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Does what is due at `now`.
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const;

    /// Sends `request`, whose header is filled in here, and returns the handle that its Response
    /// will have. Any number may be under way. It ends `timeout` after the time of the last feed()
    /// or handle_deadline(); zero: as configured.
    template <typename Request>
    [[nodiscard]] Result<std::uint32_t> send(Request&& request, Duration timeout = {});
    /// Sends a request that `encode` writes with the given header; its Response returns `context`.
    [[nodiscard]] Result<std::uint32_t>
    send_encoded(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode,
                 Duration timeout = {}, std::uint64_t context = 0);
    /// Opens a session over a channel that was opened without one; Ready comes a second time. The
    /// parts of `config` that concern the channel are ignored. Bad_InvalidState if it is not Ready,
    /// or has a session.
    [[nodiscard]] Result<void> open_session(ConnectionConfig config);
    /// Forgets a request: no Response event will come for it. If it is under way in a session the
    /// server is told, once, so that it does not work in vain (Part 4, 5.7.5).
    void cancel(std::uint32_t handle);
    /// Forgets a request without telling the server.
    void forget(std::uint32_t handle);
    /// Gives the session, which is Ready, to another user (Part 4, 5.7.3.1). A Response with the
    /// handle has the result; if it is bad, the session keeps its user. Bad_InvalidState without a
    /// session or during another change; Bad_IdentityTokenRejected if the server has no token
    /// policy for such a user, unless `token_policy` is given.
    [[nodiscard]] Result<std::uint32_t> change_user(UserIdentity identity,
                                                    std::optional<UserTokenPolicy> token_policy);
    /// Closes session and channel (Part 4, 5.7.4 and 5.6.3), with or without the Subscriptions.
    void close(bool deletes_subscriptions = true);
    /// Closes the channel and leaves the session to the server, for another connection.
    void leave();

    /// The endpoints that the server returned in CreateSession.
    [[nodiscard]] const Array<EndpointDescription>& endpoints() const;
    /// The session once Ready; its authentication token is null if there is none.
    [[nodiscard]] const SessionTicket& session() const;
    /// True if it is the resumed session of the configuration.
    [[nodiscard]] bool is_resumed() const;
    /// The URL in our Hello; with is_reverse, the one in the server's ReverseHello.
    [[nodiscard]] const std::string& endpoint_url() const;

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

template <typename T>
Result<T> ConnectionEvent::response(const binary::DecodeLimits& limits,
                                    const binary::TypeRegistry& types) const
{
    if (status.is_bad()) {
        return fail(status);
    }
    return decode_response<T>(body, binary::Strings::Borrow, limits, types);
}

template <typename Request>
Result<std::uint32_t> Connection::send(Request&& request, Duration timeout)
{
    using Type = std::remove_cvref_t<Request>;
    return send_encoded(
        [&](binary::Writer& writer, const RequestHeader& header) {
            request.request_header = header;
            encode(writer, NodeId{0, Type::binary_encoding_id});
            encode(writer, request);
        },
        timeout);
}

} // namespace busbar::client
