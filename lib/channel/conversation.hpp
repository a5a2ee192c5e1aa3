#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/channel/channel_types.hpp>
#include <busbar/core/function_ref.hpp>

#include "assembly.hpp"
#include "asymmetric_message.hpp"
#include "frame.hpp"
#include "output_buffer.hpp"
#include "symmetric_chunk.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// One frame in the input buffer; valid until the next feed() or next_frame().
struct Frame {
    FrameHeader header;
    std::span<std::byte> bytes; // including the header

    [[nodiscard]] std::span<const std::byte> body() const { return bytes.subspan(header_size); }
};

/// The end of the connection.
enum class Role : std::uint8_t { Server, Client };

/// The common part of both ends of a connection: framing, tokens, sequence numbers, joining chunks,
/// and sending.
class Conversation {
public:
    /// `spares` may be null.
    Conversation(const TransportLimits& limits, const ChannelEnvironment& environment, Role role,
                 SpareBuffers* spares = nullptr);
    Conversation(const Conversation&) = delete;
    Conversation& operator=(const Conversation&) = delete;
    ~Conversation();

    // Input -----------------------------------------------------------------------------------

    void feed(std::span<const std::byte> in);
    /// Returns the next whole frame, or none yet. Fails if the input cannot be a frame.
    [[nodiscard]] Result<std::optional<Frame>> next_frame();
    /// Puts the last frame back: next_frame() returns none until is_held is false again.
    void hold(const Frame& frame);
    bool is_held{false};
    /// Checks a MSG or CLO chunk against token, signature and sequence (Part 6, 6.7.7);
    /// Bad_TcpSecureChannelUnknown, Bad_SecureChannelTokenUnknown, Bad_SecurityChecksFailed or
    /// Bad_SequenceNumberInvalid.
    [[nodiscard]] Result<SymmetricContent> open(const Frame& frame, TimePoint now);
    [[nodiscard]] Assembly& assembly() { return assembly_; }
    /// Checks and counts the sequence number of an OPN.
    [[nodiscard]] bool accept_sequence(std::uint32_t number);

    // Output ----------------------------------------------------------------------------------

    [[nodiscard]] OutputBuffer& output() { return output_; }
    [[nodiscard]] const OutputBuffer& output() const { return output_; }
    [[nodiscard]] Result<void> send(MessageType type, std::uint32_t request_id,
                                    FunctionRef<void(binary::Writer&)> encode);
    /// Returns the parts of the next OPN, whose place among all chunks this is; without body,
    /// sender and receiver.
    [[nodiscard]] AsymmetricParts open_parts(std::uint32_t request_id);
    [[nodiscard]] Result<void> send_open(std::uint32_t request_id, std::span<const std::byte> body,
                                         const crypto::Certificate* receiver);

    // State -----------------------------------------------------------------------------------

    /// Applies the result of Hello and Acknowledge.
    void negotiate(const Hello& agreed);
    /// Client: uses `token` for sending; the previous one is accepted until it expires (Part 4,
    /// 5.6.2.1).
    void use(Token token);
    /// Server: accepts `token` too; it is used for sending from the first message on that the
    /// client secures with it, or when the previous one has ended (Part 4, 5.6.2.1).
    void offer(Token token);
    /// The time of the next expire(); no_deadline before there is a token.
    [[nodiscard]] TimePoint expires_at() const;
    /// Drops tokens that have expired at `now`. True if none is left.
    [[nodiscard]] bool expire(TimePoint now);
    [[nodiscard]] TimePoint renew_at() const;
    /// Bytes that the buffers hold.
    [[nodiscard]] std::size_t memory_in_use() const;

    SecuritySetting security;
    std::uint32_t channel_id{0};
    crypto::CertificateChain peer_certificates;
    [[nodiscard]] const ChannelEnvironment& environment() const { return environment_; }
    [[nodiscard]] const Hello& sizes() const { return sizes_; }
    /// Our own limits, complete.
    [[nodiscard]] const TransportLimits& limits() const { return limits_; }
    std::uint32_t max_frame_size{max_early_size};

private:
    [[nodiscard]] Token* find_token(std::uint32_t id, TimePoint now);
    void note_use(const Token& token);
    void input_is_done();

    TransportLimits limits_;
    ChannelEnvironment environment_;
    Role role_;
    SpareBuffers* spares_;
    Hello sizes_; // our receive and send sizes, the peer's message limits
    std::vector<std::byte> input_;
    std::size_t input_begin_{0};
    OutputBuffer output_;
    std::optional<Token> current_;
    std::optional<Token> previous_;
    std::optional<Token> offered_;
    SequenceNumbers sent_;
    SequenceNumbers received_;
    Assembly assembly_;
};

/// Encodes a structure after its encoding's NodeId, as in messages.
template <typename T>
void encode_message(binary::Writer& writer, const T& structure)
{
    encode(writer, NodeId{0, T::binary_encoding_id});
    encode(writer, structure);
}

/// Decodes the structure of a message's body as a T; Bad_DecodingError if it is another one.
template <typename T>
[[nodiscard]] Result<T> decode_message(std::span<const std::byte> body)
{
    binary::Reader reader{body};
    NodeId id;
    T structure;
    decode(reader, id);
    if (!id.is(T::binary_encoding_id)) {
        return fail(status::Bad_DecodingError);
    }
    decode(reader, structure);
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_DecodingError);
    }
    return structure;
}

} // namespace busbar::channel::detail
