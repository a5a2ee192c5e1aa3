#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/string.hpp>

#include "output_buffer.hpp"

namespace busbar::channel::detail {

enum class MessageType : std::uint8_t { HEL, ACK, ERR, RHE, OPN, MSG, CLO };

inline constexpr std::size_t header_size = 8;
/// MSG and CLO: message header, SecureChannelId, TokenId (Part 6, 6.7.2.2 and 6.7.2.4).
inline constexpr std::size_t symmetric_header_size = 16;
inline constexpr std::size_t sequence_header_size = 8;
/// Maximum size of URLs in the connection protocol's messages (Part 6, 7.1.2.3).
inline constexpr std::uint32_t max_url_size = 4'096;
/// Maximum size of messages before the buffer sizes are agreed.
inline constexpr std::uint32_t max_early_size =
    header_size + 20 + 2 * (4U + std::size_t{max_url_size});

/// The first eight bytes of every message (Part 6, 7.1.2.2).
struct FrameHeader {
    MessageType type{MessageType::HEL};
    char chunk{'F'}; // 'F'inal, 'C'ontinued, 'A'borted
    std::uint32_t size{0};
};

/// Returns Bad_TcpMessageTypeInvalid if the type or the chunk flag is unknown or the size less than
/// a header; Bad_TcpMessageTooLarge if it is more than `max_size`. `bytes` has header_size bytes or
/// more.
[[nodiscard]] BUSBAR_API Result<FrameHeader> parse_frame_header(std::span<const std::byte> bytes,
                                                                std::uint32_t max_size);
/// Writes the header over the first bytes of `to`.
void write_frame_header(std::span<std::byte> to, const FrameHeader& header);

/// Hello and Acknowledge (Part 6, 7.1.2.3 and 7.1.2.4).
struct Hello {
    std::uint32_t protocol_version{0};
    std::uint32_t receive_buffer_size{0};
    std::uint32_t send_buffer_size{0};
    std::uint32_t max_message_size{0};
    std::uint32_t max_chunk_count{0};
    String endpoint_url; // not in Acknowledge
};
[[nodiscard]] Result<Hello> parse_hello(std::span<const std::byte> body);
[[nodiscard]] Result<Hello> parse_acknowledge(std::span<const std::byte> body);
void write_hello(OutputBuffer& output, const Hello& hello);
void write_acknowledge(OutputBuffer& output, const Hello& acknowledge);

/// Error (Part 6, 7.1.2.5).
struct ErrorMessage {
    StatusCode error;
    String reason;
};
[[nodiscard]] Result<ErrorMessage> parse_error(std::span<const std::byte> body);
BUSBAR_API void write_error(OutputBuffer& output, StatusCode error, std::string_view reason);

/// ReverseHello (Part 6, 7.1.2.6).
struct ReverseHello {
    String server_uri;
    String endpoint_url;
};
[[nodiscard]] BUSBAR_API Result<ReverseHello> parse_reverse_hello(std::span<const std::byte> body);
void write_reverse_hello(OutputBuffer& output, std::string_view server_uri,
                         std::string_view endpoint_url);

} // namespace busbar::channel::detail
