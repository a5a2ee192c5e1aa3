#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <busbar/client/connection.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/seeded_random.hpp>
#include <busbar/harness/world.hpp>

namespace busbar::harness {

/// The parts that a hosted client needs in addition to its configuration. All pointers must outlive
/// the host.
struct ClientParts {
    /// If null, every certificate is accepted.
    crypto::CertificateValidator* validator{nullptr};
    /// Needed for every policy except None.
    const channel::ApplicationIdentity* identity{nullptr};
    /// If null, the world's log.
    LogSink* log{nullptr};
    /// The client's address as the server sees it.
    std::string address{"192.0.2.1"};
    /// Time from ordering a connection until it is open, or refused.
    Duration connect_time{std::chrono::milliseconds{1}};
    /// The ApplicationUri in sessions of a ScriptedClient; the other hosts have it in their
    /// configuration.
    std::string application_uri{"urn:busbar:harness:client"};
    /// Makes nonces; if null, numbers of the world, which protect nothing. For a ConnectionHost.
    crypto::Random* random{nullptr};
    /// Receives the keys of its channels, in builds with BUSBAR_KEY_LOG; null for none.
    channel::KeyLog* key_log{nullptr};
};

/// Returns the configuration for the server of open_server_config(): an anonymous user without
/// security.
[[nodiscard]] BUSBAR_API client::ConnectionConfig open_connection_config();

/// Runs a client::Connection in a world: one connection to one server, and another one on request.
/// One thread; the world must outlive it.
class BUSBAR_API ConnectionHost final : private LinkEnd {
public:
    explicit ConnectionHost(World& world,
                            client::ConnectionConfig config = open_connection_config(),
                            const ClientParts& parts = {});
    ~ConnectionHost() override;

    /// Connects and opens a session, or only the channel if no session is wanted; an earlier
    /// connection is dropped without notice. Runs the world until that is done. Bad_Timeout, or the
    /// status that the Connection was closed with.
    Result<void> open(Duration limit = std::chrono::minutes{1});
    /// Closes the session and the connection properly.
    void close();
    /// Leaves without notice: the server keeps the session until it times out.
    void drop();
    [[nodiscard]] bool is_ready() const { return is_ready_; }
    /// The reason why the last connection ended; nothing while it is open.
    [[nodiscard]] std::optional<StatusCode> closed_by() const { return closed_by_; }
    /// Only while there is a connection.
    [[nodiscard]] client::Connection& connection() { return *connection_; }

    /// Sends a request and runs the world until its response arrives. The response owns its
    /// strings. Fails with the ServiceResult if that is bad, Bad_Timeout if `limit` is over first,
    /// Bad_ConnectionClosed if the connection is lost, Bad_NotConnected without one. Must not be
    /// called within a handler.
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request request, Duration limit = std::chrono::minutes{1});
    /// Sends a request; `then` gets what call() would return, once, while the world runs. It may
    /// send further requests.
    template <typename Response, typename Request>
    void send(Request request, std::function<void(Result<Response>)> then);
    /// Sends a request whose body is encoded: NodeId, header, fields. The header is replaced by one
    /// of this connection. `then` gets the body of what came, a ServiceFault too; empty if nothing
    /// did.
    void send_body(std::span<const std::byte> body,
                   std::function<void(std::vector<std::byte> body)> then);

private:
    using Handler = std::function<void(Result<client::ResponseBody>)>;
    using BodyHandler = std::function<void(std::vector<std::byte>)>;

    // LinkEnd.
    [[nodiscard]] std::span<const std::byte> output() const override
    {
        return connection_->output();
    }
    void consume(std::size_t size) override { connection_->consume(size); }
    void feed(std::span<const std::byte> in) override;
    void link_lost() override { end(status::Bad_ConnectionClosed); }

    void connect();
    /// Passes the time to the Connection, from which it counts the time of a request.
    void tell_time();
    void update();
    void handle(client::ConnectionEvent event);
    void await(Result<std::uint32_t> sent, Handler handler);
    void end(StatusCode status);

    World& world_;
    client::ConnectionConfig config_;
    ClientParts parts_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    std::optional<client::Connection> connection_;
    std::shared_ptr<Link> link_;
    std::map<std::uint32_t, Handler> handlers_;
    std::map<std::uint32_t, BodyHandler> body_handlers_;
    std::optional<StatusCode> closed_by_;
    bool is_ready_{false};
    Alarm connect_;
    Alarm deadline_;
};

template <typename Response, typename Request>
void ConnectionHost::send(Request request, std::function<void(Result<Response>)> then)
{
    tell_time();
    auto sent = is_ready_ ? connection_->send(std::move(request)) : fail(status::Bad_NotConnected);
    await(std::move(sent), [then = std::move(then), limits = config_.limits](auto body) {
        then(body ? body->template decoded<Response>(limits) : fail(body.error()));
    });
}

template <typename Response, typename Request>
Result<Response> ConnectionHost::call(Request request, Duration limit)
{
    const auto answer = std::make_shared<std::optional<Result<Response>>>();
    send<Response>(std::move(request), [answer](Result<Response> response) { //
        *answer = std::move(response);
    });
    if (!world_.run_until([&] { return answer->has_value(); }, limit)) {
        return fail(status::Bad_Timeout);
    }
    return std::move(**answer);
}

} // namespace busbar::harness
