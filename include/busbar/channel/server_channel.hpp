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

struct ServerChannelConfig {
    TransportLimits limits;
    /// What an OpenSecureChannel may ask for; anything else is refused.
    std::vector<SecuritySetting> allowed;
    /// The lifetime of a SecurityToken is brought into this range (Part 4, 5.6.2).
    std::chrono::milliseconds min_lifetime{10'000};
    std::chrono::milliseconds max_lifetime{3'600'000};
    /// Not zero, and of this channel only while it lives.
    std::uint32_t channel_id{1};
    /// From where the peer is, for the validator (see crypto::ValidationContext).
    std::string source{};
    /// Optional: what channels of one server share, for it must outlive them. Null where
    /// connections are few; each keeps buffers of its own then.
    SpareBuffers* spares{nullptr};
    /// Optional, in the same way; null: whoever connects again is parsed again.
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

    /// Sends ReverseHello instead of waiting for the client's connection (Part 6, 7.1.2.6). Only
    /// before anything was fed, and with texts of at most 4096 bytes: else Bad_InvalidArgument.
    /// The client may then say nothing for as long as it has no use for the connection; the time
    /// for its handshake begins with its first byte.
    [[nodiscard]] Result<void> reverse_hello(std::string_view server_uri,
                                             std::string_view endpoint_url);

    /// Takes bytes from the peer; bad once the channel is closed. Then poll next_event() until
    /// there is none: that is what works on the bytes. An owner whose peer does not read, so that
    /// output() grows, should stop feeding.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::optional<ChannelEvent> next_event();
    /// Bytes for the peer, valid until the next call of any other member but consume(); with
    /// SpareBuffers, of any member of a channel that shares them.
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);

    /// Sends the message that `encode` writes, in as many chunks as it takes. If it is past the
    /// client's limits (Bad_ResponseTooLarge) or `encode` fails, nothing is sent and the channel
    /// stays as it was; the caller then sends a ServiceFault.
    [[nodiscard]] Result<void> send(std::uint32_t request_id,
                                    FunctionRef<void(binary::Writer&)> encode);
    /// Sends an Error message and closes.
    void close(StatusCode status, std::string_view reason);

    /// The size in bytes of a message body that certainly fits the client's limits and one's own.
    [[nodiscard]] std::size_t max_response_size() const;

    /// From now on a message of more than `size` bytes from the client ends the channel with
    /// Bad_TcpMessageTooLarge; the limit agreed in Acknowledge stays the upper bound. For peers who
    /// are not to have all that the limits allow yet.
    void limit_messages(std::uint32_t size);
    /// Takes the memory for a response of one chunk, so that sending one needs no more. Optional.
    /// With SpareBuffers as long as no other channel sends something in between.
    void reserve_response();
    /// Gives a Message's body back, so that the next one needs no allocation. Optional.
    void recycle(std::vector<std::byte> body);
    /// Bytes for the peer, those included that wait behind the answer to a renewal which is with
    /// the OpenWorker: output() does not have them yet.
    [[nodiscard]] std::size_t unsent_size() const;
    /// Bytes of a message that has begun and is not complete; none once the channel is closed.
    [[nodiscard]] std::size_t unfinished_size() const;
    /// Bytes that the buffers of this connection hold now, for the owner's accounts.
    [[nodiscard]] std::size_t memory_in_use() const;

    /// The OpenGate lets an OpenSecureChannel wait until next_deadline() at the latest, or the
    /// OpenWorker has it, and with it waits all that was fed since: feed no more, or it piles up
    /// here.
    [[nodiscard]] bool is_waiting() const;
    /// What the OpenWorker has started last is done; a bad `status` if it was not, which ends the
    /// channel: Bad_TcpServerTooBusy if others went first, else what its run() failed with. Nothing
    /// happens if the channel has ended meanwhile. Then poll next_event().
    void work_done(StatusCode status, TimePoint now);
    [[nodiscard]] bool is_open() const;
    [[nodiscard]] bool is_closed() const;
    [[nodiscard]] std::uint32_t channel_id() const;
    /// How the channel is secured; only while it is open.
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
