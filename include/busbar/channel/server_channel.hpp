#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>

namespace busbar::channel {

class SpareBuffers;

/// The configuration of a ServerChannel.
struct ServerChannelConfig {
    TransportLimits limits;
    /// The settings that an OpenSecureChannel may request; anything else is refused.
    std::vector<SecuritySetting> allowed;
    /// The revised lifetime of a SecurityToken is in this range (Part 4, 5.6.2).
    std::chrono::milliseconds min_lifetime{10'000};
    std::chrono::milliseconds max_lifetime{3'600'000};
    /// Not zero, and unique while the channel lives.
    std::uint32_t channel_id{1};
    /// The peer's origin, for the validator (see crypto::ValidationContext).
    std::string source{};
    /// Optional: buffers that the channels of one server share; must outlive them. Null if
    /// connections are few; each channel has its own buffers then.
    SpareBuffers* spares{nullptr};
    /// Optional, in the same way; if null, the certificates of a returning peer are parsed again.
    crypto::KnownCertificates* known_certificates{nullptr};
};

/// The server's end of one connection: UA TCP (Part 6, 7.1) and the SecureChannel (Part 6, 6.7).
///
/// A state machine: bytes and the time go in, bytes, events and the next deadline come out. Errors
/// of the peer end in an Error message in output() and a Closed event. One thread at a time.
class BUSBAR_API ServerChannel {
public:
    ServerChannel(ServerChannelConfig config, const ChannelEnvironment& environment, TimePoint now);
    ServerChannel(ServerChannel&&) noexcept;
    ServerChannel& operator=(ServerChannel&&) noexcept;
    ~ServerChannel();

    /// Sends ReverseHello instead of waiting for the client's connection (Part 6, 7.1.2.6). Allowed
    /// only before anything was fed, and with texts of at most 4096 bytes: else
    /// Bad_InvalidArgument. The client may then stay silent as long as it does not need the
    /// connection; the time for its handshake begins with its first byte.
    [[nodiscard]] Result<void> reverse_hello(std::string_view server_uri,
                                             std::string_view endpoint_url);

    /// Takes bytes from the peer; fails once the channel is closed. Then poll next_event() until
    /// there is none: that is what processes the bytes. An owner whose peer does not read, so that
    /// output() grows, should stop feeding.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::optional<ChannelEvent> next_event();
    /// Bytes for the peer, valid until the next call of any other member except consume(); with
    /// SpareBuffers, of any member of a channel that shares them.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    /// The time at which handle_deadline() has something to do; no_deadline if it has nothing.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Does what is due at `now`.
    void handle_deadline(TimePoint now);

    /// Sends the message that `encode` writes, in as many chunks as it needs. If it exceeds the
    /// client's limits (Bad_ResponseTooLarge) or `encode` fails, nothing is sent and the channel
    /// stays as it was; the caller then sends a ServiceFault.
    [[nodiscard]] Result<void> send(std::uint32_t request_id,
                                    FunctionRef<void(binary::Writer&)> encode);
    /// Sends an Error message and closes.
    void close(StatusCode status, std::string_view reason);

    /// The size in bytes of a message body that certainly fits the client's limits and our own.
    [[nodiscard]] std::size_t max_response_size() const;

    /// From now on a message of more than `size` bytes from the client ends the channel with
    /// Bad_TcpMessageTooLarge; the limit agreed in Acknowledge stays the upper bound. For peers
    /// that may not use the full limits yet.
    void limit_messages(std::uint32_t size);
    /// Allocates the memory for a response of one chunk, so that sending one needs no more.
    /// Optional. With SpareBuffers it holds until another channel sends something.
    void reserve_response();
    /// Takes a Message's body back, so that the next one needs no allocation. Optional.
    void recycle(std::vector<std::byte> body);
    /// Bytes for the peer, including those that wait for the answer to a renewal which the
    /// OpenWorker is preparing: output() does not have them yet.
    [[nodiscard]] std::size_t unsent_size() const;
    /// Bytes of an incomplete message; 0 once the channel is closed.
    [[nodiscard]] std::size_t unfinished_size() const;
    /// Bytes that the buffers of this connection hold now, for the owner's accounts.
    [[nodiscard]] std::size_t memory_in_use() const;

    /// True while the OpenGate delays an OpenSecureChannel, until next_deadline() at the latest, or
    /// while the OpenWorker works on it. Everything that was fed since waits as well: feed no more,
    /// or it accumulates here.
    [[nodiscard]] bool is_waiting() const;
    /// Completes the work that the OpenWorker started last; a bad `status` if it was not done,
    /// which ends the channel: Bad_TcpServerTooBusy if other work took precedence, else the error
    /// of its run(). Does nothing if the channel has ended meanwhile. Then poll next_event().
    void work_done(StatusCode status, TimePoint now);
    [[nodiscard]] bool is_open() const;
    [[nodiscard]] bool is_closed() const;
    [[nodiscard]] std::uint32_t channel_id() const;
    /// The security of the channel; only while it is open.
    [[nodiscard]] const SecuritySetting& security() const;
    /// The client's certificates; empty with policy None.
    [[nodiscard]] const crypto::CertificateChain& peer_certificates() const;
    /// The URL in the client's Hello.
    [[nodiscard]] const std::string& endpoint_url() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::channel
