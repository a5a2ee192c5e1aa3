#pragma once

#include <memory>
#include <optional>
#include <string>

#include <busbar/channel/client_channel.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/scripted_server.hpp>

namespace busbar::harness {

namespace detail {
class WrongChunks;
} // namespace detail

/// A client that sends what a test wants, in and out of turn, rightly or not. It handles the
/// channel by itself; services are up to the test, and so are bytes that are not a message:
///
///     ScriptedClient client{world, config};
///     need(client.open());
///     need(client.open_session());
///     need(client.send(request, {.sequence = Wrong::Sequence::Again}));
///
/// ConnectionHost sends what a proper client sends. One thread; the world must outlive it.
class BUSBAR_API ScriptedClient final : private LinkEnd {
public:
    /// It connects to `config.endpoint_url`.
    ScriptedClient(World& world, channel::ClientChannelConfig config,
                   const ClientParts& parts = {});
    ~ScriptedClient() override;

    /// Connects and opens the channel; runs the world until it is open. The error is the reason why
    /// it did not open, or Bad_Timeout.
    Result<void> open(Duration limit = std::chrono::minutes{1});
    /// Connects and sends nothing: for the bytes of the test, whose answers are received().
    Result<void> dial();
    /// Creates and activates a session of an anonymous user, with what the channel's security
    /// needs; runs the world meanwhile. The error is expect()'s.
    Result<void> open_session(Duration limit = std::chrono::minutes{1});
    /// Sends a request unchanged, except that a request handle of 0 becomes a new one, a null
    /// authentication token the session's, and a null timestamp the time of day. Returns its
    /// RequestId, 0 if `wrong` sends it never; Bad_NotConnected without a channel.
    template <typename Request>
    Result<std::uint32_t> send(Request request, const Wrong& wrong = {})
    {
        if (request.request_header.request_handle == 0) {
            request.request_header.request_handle = ++last_handle_;
        }
        if (request.request_header.authentication_token.is_null()) {
            request.request_header.authentication_token = authentication_token_;
        }
        if (request.request_header.timestamp == DateTime{}) {
            request.request_header.timestamp = world_.clock().now();
        }
        auto body = encode_body(request);
        return body ? send_body(*body, wrong) : fail(body.error());
    }
    /// Sends bytes past the channel, whole chunks or anything else.
    void send_bytes(std::span<const std::byte> bytes);
    /// Returns what has come since dial(); empty after open().
    [[nodiscard]] const std::vector<std::byte>& received() const { return received_; }
    /// The open channel, whose id a chunk of one's own needs.
    [[nodiscard]] const channel::ClientChannel& channel() const { return *channel_; }
    /// The SecurityToken of the last message; 0 before there was one.
    [[nodiscard]] std::uint32_t token_id() const;
    /// Returns the token of the session; null without one.
    [[nodiscard]] const NodeId& authentication_token() const { return authentication_token_; }
    /// Runs the world until a message arrives, and returns the response, or an error: the status of
    /// a ServiceFault, Bad_UnknownResponse for another structure, Bad_Timeout, or the status that
    /// the connection was closed with. A mismatch is added to the report.
    template <typename Response>
    [[nodiscard]] Result<Response> expect(Duration limit = std::chrono::minutes{1})
    {
        auto body = await(Response::binary_encoding_id, limit);
        return body ? decode_body<Response>(*body) : fail(body.error());
    }
    /// Runs the world until the connection is closed; returns the server's status, Good if it sent
    /// none.
    [[nodiscard]] Result<StatusCode> expect_close(Duration limit = std::chrono::minutes{1});
    /// The expected messages that did not arrive, one a line; empty if all arrived.
    [[nodiscard]] const std::string& report() const { return report_; }

private:
    // LinkEnd.
    [[nodiscard]] std::span<const std::byte> output() const override;
    void consume(std::size_t size) override;
    void feed(std::span<const std::byte> in) override;
    void link_lost() override;

    void update();
    [[nodiscard]] Result<void> connect();
    [[nodiscard]] Result<std::uint32_t> send_body(std::span<const std::byte> body,
                                                  const Wrong& wrong);
    [[nodiscard]] Result<std::vector<std::byte>> await(std::uint32_t encoding_id, Duration limit);

    World& world_;
    channel::ClientChannelConfig config_;
    ClientParts parts_;
    LogSink& log_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    std::unique_ptr<detail::WrongChunks> chunks_;
    std::optional<channel::ClientChannel> channel_;
    std::shared_ptr<Link> link_;
    std::vector<std::byte> raw_;
    std::vector<std::byte> received_;
    NodeId authentication_token_;
    std::deque<std::vector<std::byte>> messages_;
    std::optional<StatusCode> closed_by_;
    std::string report_;
    std::uint32_t last_handle_{0};
    bool is_open_{false};
    Alarm deadline_;
};

} // namespace busbar::harness
