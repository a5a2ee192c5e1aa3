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

#include "asymmetric_message.hpp"
#include "frame.hpp"
#include "output_buffer.hpp"
#include "symmetric_chunk.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// One frame in the input buffer; valid until the next feed().
struct Frame {
    FrameHeader header;
    std::span<std::byte> bytes; // with the header

    [[nodiscard]] std::span<const std::byte> body() const { return bytes.subspan(header_size); }
};

/// What both ends of a connection have in common: framing, tokens, sequence numbers, assembly of
/// chunks, and sending.
class Conversation {
public:
    Conversation(const TransportLimits& limits, const ChannelEnvironment& environment,
                 StatusCode too_large);

    // Input -----------------------------------------------------------------------------------

    void feed(std::span<const std::byte> in);
    /// The next whole frame, or none yet. Bad if what is there can be no frame.
    [[nodiscard]] Result<std::optional<Frame>> next_frame();
    /// Checks a MSG or CLO chunk against token, signature and sequence;
    /// Bad_TcpSecureChannelUnknown, Bad_SecureChannelTokenUnknown or Bad_SecurityChecksFailed.
    [[nodiscard]] Result<SymmetricContent> open(const Frame& frame, TimePoint now);
    /// Adds a chunk to the message that is being assembled. The message when it is complete, none
    /// while it is not or after it was aborted (then `aborted` has its status).
    [[nodiscard]] Result<std::optional<Event>> assemble(const Frame& frame,
                                                        const SymmetricContent& content);
    /// Checks and counts the sequence number of an OPN.
    [[nodiscard]] bool accept_sequence(std::uint32_t number);

    // Output ----------------------------------------------------------------------------------

    [[nodiscard]] OutputBuffer& output() { return output_; }
    [[nodiscard]] const OutputBuffer& output() const { return output_; }
    [[nodiscard]] Result<void> send(MessageType type, std::uint32_t request_id,
                                    FunctionRef<void(binary::Writer&)> encode);
    [[nodiscard]] Result<void> send_open(std::uint32_t request_id, std::span<const std::byte> body,
                                         const crypto::Certificate* receiver);

    // State -----------------------------------------------------------------------------------

    /// Takes over what Hello and Acknowledge agreed on.
    void negotiate(const Hello& agreed);
    /// Makes `token` the one that is sent with; the one before is accepted until it expires.
    void use(Token token);
    /// Accepts `token` too; it is sent with from the first message on that the peer secures with
    /// it.
    void offer(Token token);
    /// When the token that is in use ends, no_deadline before there is one.
    [[nodiscard]] TimePoint expires_at() const;
    [[nodiscard]] TimePoint renew_at() const;

    SecuritySetting security;
    std::uint32_t channel_id{0};
    crypto::CertificateChain peer_certificates;
    [[nodiscard]] const ChannelEnvironment& environment() const { return environment_; }
    [[nodiscard]] const Hello& sizes() const { return sizes_; }
    std::uint32_t max_frame_size{max_early_size};

private:
    [[nodiscard]] Token* find_token(std::uint32_t id, TimePoint now);
    void reset_assembly();

    TransportLimits limits_;
    ChannelEnvironment environment_;
    StatusCode too_large_;
    Hello sizes_; // ours to receive and send, the peer's message limits
    std::vector<std::byte> input_;
    std::size_t input_begin_{0};
    OutputBuffer output_;
    std::optional<Token> current_;
    std::optional<Token> previous_;
    std::optional<Token> offered_;
    SequenceNumbers sent_;
    SequenceNumbers received_;
    std::vector<std::byte> message_;
    std::uint32_t message_request_id_{0};
    std::uint32_t message_chunks_{0};
};

/// One structure with its encoding's NodeId in front, as messages carry it.
template <typename T>
void encode_message(binary::Writer& writer, const T& structure)
{
    encode(writer, NodeId{0, T::binary_encoding_id});
    encode(writer, structure);
}

/// The structure of a message's body if it is a T; Bad_DecodingError otherwise.
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
