#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <busbar/channel/channel_types.hpp>
#include <busbar/client/endpoint_choice.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/client/response_limits.hpp>
#include <busbar/client/subscriptions.hpp>
#include <busbar/client/user_identity.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>

namespace busbar::client {

/// The delays before a lost connection is tried again: first `first`, then `factor` times as long
/// each time, up to `longest`, each shortened at random by up to a fifth, so that the clients of a
/// plant do not all return at once.
struct ReconnectPolicy {
    bool is_enabled{true};
    Duration first{std::chrono::seconds{1}};
    double factor{2};
    Duration longest{std::chrono::seconds{30}};
    /// Gives up with the last error after this many attempts in a row; 0: never.
    std::uint32_t max_attempts{0};
};

/// The configuration of a Client.
struct ClientConfig {
    /// opc.tcp://host:port/path, of the server or of one of its discovery endpoints.
    std::string endpoint_url;
    SecurityWishes security;
    UserIdentity identity;
    std::string application_uri{"urn:busbar:client"};
    std::string application_name{"Busbar client"};
    std::string session_name{"Busbar"};
    Duration session_timeout{std::chrono::minutes{1}};
    /// LocaleIds of texts in order of preference (Part 4, 5.4); if empty, the server chooses.
    std::vector<std::string> locale_ids;
    Duration request_timeout{std::chrono::seconds{10}};
    /// Limits one attempt, from ordering a connection to a session.
    Duration connect_timeout{std::chrono::seconds{20}};
    /// The time that the server has to end the connection over which endpoints were requested,
    /// before the next one is opened: a server with few connections refuses it until then.
    Duration peer_close_timeout{std::chrono::seconds{1}};
    /// Server_State is read when the server has been silent for this long, or for a third of the
    /// session's timeout; after two such reads without an answer the connection is given up. Zero:
    /// never, and a session without requests times out.
    Duration keep_alive_interval{std::chrono::seconds{5}};
    ReconnectPolicy reconnect;
    Duration channel_lifetime{std::chrono::hours{1}};
    channel::TransportLimits transport;
    /// Limits of a response.
    binary::DecodeLimits decode{response_limits};
    /// Generated structures in addition to those of namespace 0, a table for each namespace: their
    /// values in responses and notifications are objects of their C++ types. Found by their
    /// namespace URI in the server's NamespaceArray, whatever the index is there.
    std::vector<binary::TypeRegistry::Table> types;
    SubscriberLimits subscriptions;
    /// Maximum number of requests that wait or are under way; further ones fail with
    /// Bad_TooManyOperations.
    std::size_t max_requests{10'000};
    /// Maximum number of entries that are kept of the server's NamespaceArray and of its
    /// ServerArray.
    std::size_t max_server_names{10'000};
    /// If not empty, only a server with this ApplicationUri is accepted.
    std::string server_uri;
    /// False for FindServers, GetEndpoints and RegisterServer, which need no session. If
    /// security.allows_none is set too, the channel is opened without security and without
    /// requesting endpoints.
    bool wants_session{true};
    /// Requests endpoints even so: security is better than none if the server has any.
    bool asks_for_endpoints{false};
    /// The server connects to us (Part 6, 7.1.2.6).
    bool is_reverse{false};
};

/// The stage of a Client on its way to a session.
enum class ClientState : std::uint8_t {
    Waiting,     // for the next attempt, or for the first call of connect()
    Connecting,  // a transport was ordered
    Discovering, // GetEndpoints over a channel without security
    Opening,     // the channel and the session, and reading the server's capabilities
    Ready,
    Closing,
    Closed, // by close(), or for good
};

/// An order for the owner of a Client about its transport. One at a time: the next Open comes when
/// disconnected() has confirmed a Drop, or two seconds later; the rest of the old connection must
/// then be closed at once.
struct TransportOrder {
    /// The task of the owner of the transport.
    enum class Kind : std::uint8_t {
        Open, // connect to `url`, or wait for a ReverseHello if the configuration says so
        Drop, // send the rest of output(), then close the connection
    };
    Kind kind{Kind::Open};
    /// Identifies the attempt; reports about older ones are ignored.
    std::uint64_t id{0};
    std::string url{};
    /// Drop: call disconnected() only when the server has ended the connection, too, preferably
    /// after a half-close. The Client waits for ClientConfig::peer_close_timeout.
    bool awaits_peer{false};
};

/// A client that stays connected to one server: finds the best endpoint, opens channel and session,
/// keeps them alive, and restores them when they are lost, Subscriptions included.
///
/// Sans-I/O and polled. Bytes, time and the results of orders go in; bytes, orders and the next
/// deadline come out. After any other call poll() until it returns false, then look at
/// next_order(), output() and next_deadline(); while poll() returns true, read no more from the
/// peer. Handlers run in poll() only, and poll() does a bounded piece of work, so that a PLC task
/// can step a Client in its cycle. One thread; the net layer has drivers.
///
/// Handlers may use the Client, but neither poll() nor destroy it.
class BUSBAR_API Client final : public Requester {
public:
    /// `environment` must outlive the Client; the validator decides on the server's certificate.
    Client(ClientConfig config, const channel::ChannelEnvironment& environment, TimePoint now);
    /// Drops everything at once; handlers are not called any more.
    ~Client() override;

    /// From now on the Client tries to be connected, also after Closed.
    void connect(TimePoint now);
    /// Closes session and channel, and deletes Subscriptions at the server or leaves them to a
    /// client that will take them over. Requests end with Bad_ConnectionClosed. The state is
    /// Closing until the transport is closed.
    void close(TimePoint now, bool deletes_subscriptions = true);

    [[nodiscard]] ClientState state() const;
    /// The reason why the Client is not Ready: the last failure; Good before the first and after
    /// close().
    [[nodiscard]] StatusCode last_error() const;
    /// The endpoint that is used or will be tried next; null while none is chosen.
    [[nodiscard]] const EndpointDescription* endpoint() const;
    /// Called in poll() for each change of state, with the failure that caused it, or Good.
    /// Waiting: the Client will try again. Closed: it will not, because another attempt cannot help
    /// or there were too many.
    void on_state(std::function<void(ClientState, StatusCode)> handler);
    [[nodiscard]] Subscriptions& subscriptions();
    /// RevisedSessionTimeout, which the session is kept alive within; zero while not Ready.
    [[nodiscard]] Duration session_timeout() const;
    /// Gives the session to another user, who keeps its Subscriptions (Part 4, 5.7.3.1). `done` is
    /// called in poll(): with Good; with the reason why the server refuses the user or has no token
    /// policy for him, and the session keeps its user; with Bad_ConnectionClosed if the connection
    /// was lost meanwhile, and the next one resumes the session with the user that it had. While
    /// Waiting or Closed the next session, a new one, belongs to him, and the result is
    /// Good_CompletesAsynchronously. In other states, and during another change: Bad_InvalidState.
    void change_user(UserIdentity identity, std::function<void(StatusCode)> done);

    // Requester.
    void cancel(RequestId id) override;
    [[nodiscard]] const ServerInfo& server() const override;
    [[nodiscard]] TimePoint now() const override;
    [[nodiscard]] const binary::DecodeLimits& decode_limits() const override;
    [[nodiscard]] const binary::TypeRegistry& types() const override;
    [[nodiscard]] LogSink* log() const override;

    // Called by the code that drives it.

    /// Returns what the transport is to do next.
    [[nodiscard]] std::optional<TransportOrder> next_order();
    /// Reports that the transport of this order is connected.
    void connected(std::uint64_t order, TimePoint now);
    /// Reports that the attempt failed, or that the connection is closed. `reason`, which may be
    /// empty, says more about it in the log than `why`: "Connection refused".
    void disconnected(std::uint64_t order, StatusCode why, TimePoint now,
                      std::string_view reason = {});
    /// Takes bytes of the server; an error ends the connection.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    /// Only stores the time; poll() does what is due.
    void handle_deadline(TimePoint now);
    /// Handles at most `max_steps` occurrences, such as a response, and calls their handlers. True
    /// if there is more to do.
    bool poll(TimePoint now, std::size_t max_steps = 1'000);

private:
    RequestId start(Encode encode, Handler<ResponseBody> handler,
                    const RequestOptions& options) override;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::client
