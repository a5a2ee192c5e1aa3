#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/binary/writer.hpp>
#include <busbar/channel/channel_types.hpp>

#include "frame.hpp"
#include "output_buffer.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// The first sixteen bytes of a MSG or CLO chunk.
struct SymmetricHeader {
    std::uint32_t channel_id{0};
    std::uint32_t token_id{0};
};
[[nodiscard]] Result<SymmetricHeader> parse_symmetric_header(std::span<const std::byte> chunk);

/// True if this setting encrypts messages.
[[nodiscard]] bool is_encrypted(const SecuritySetting& setting);

/// Sequence header and body of a verified chunk; the body points into the chunk.
struct SymmetricContent {
    std::uint32_t sequence_number{0};
    std::uint32_t request_id{0};
    std::span<const std::byte> body;
};

/// Decrypts the chunk in place and verifies it. Every failure is Bad_SecurityChecksFailed.
[[nodiscard]] Result<SymmetricContent> open_symmetric(std::span<std::byte> chunk,
                                                      const SecuritySetting& setting, Token& token);

/// The common settings of the chunks of one outgoing message.
struct ChunkSettings {
    MessageType type{MessageType::MSG};
    std::uint32_t channel_id{0};
    std::uint32_t request_id{0};
    SecuritySetting security;
    std::uint32_t max_chunk_size{0};   // the smaller of the peer's receive and our send size
    std::uint32_t max_message_size{0}; // for all bodies together
    std::uint32_t max_chunk_count{0};
    StatusCode too_large;
    ChunkHook* hook{nullptr};
};

/// Gives a Writer the bodies of chunks in the output buffer and secures each chunk when it is full.
class ChunkSink final : public binary::Sink {
public:
    ChunkSink(OutputBuffer& output, Token& token, SequenceNumbers& sequence,
              const ChunkSettings& settings);

    [[nodiscard]] std::span<std::byte> next() override;
    [[nodiscard]] StatusCode status() const override { return status_; }

    /// Makes the last chunk, of which `filled` bytes are used, the final one.
    [[nodiscard]] bool finish(std::size_t filled);

private:
    [[nodiscard]] bool seal(std::size_t body_size, char flag);

    OutputBuffer* output_;
    Token* token_;
    SequenceNumbers* sequence_;
    ChunkSettings settings_;
    std::size_t max_body_;
    std::size_t body_total_{0};
    std::uint32_t chunks_{0};
    std::span<std::byte> chunk_;
    std::size_t chunk_body_{0};
    StatusCode status_;
};

} // namespace busbar::channel::detail
