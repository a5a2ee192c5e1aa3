#include "frame.hpp"

#include <algorithm>
#include <array>

#include <busbar/binary/codec.hpp>

namespace busbar::channel::detail {

namespace {

constexpr std::array<std::string_view, 7> type_names = {"HEL", "ACK", "ERR", "RHE",
                                                        "OPN", "MSG", "CLO"};

bool is_chunk_flag(MessageType type, char flag)
{
    // Only messages of a channel come in chunks (Part 6, 6.7.2.2 and 7.1.2.2).
    return flag == 'F' || (type == MessageType::MSG && (flag == 'C' || flag == 'A'));
}

binary::Reader body_reader(std::span<const std::byte> body)
{
    binary::DecodeLimits limits;
    limits.max_string_length = max_url_size;
    return binary::Reader{body, binary::Strings::Own, nullptr, limits};
}

Hello read_sizes(binary::Reader& reader)
{
    Hello hello;
    hello.protocol_version = reader.number<std::uint32_t>();
    hello.receive_buffer_size = reader.number<std::uint32_t>();
    hello.send_buffer_size = reader.number<std::uint32_t>();
    hello.max_message_size = reader.number<std::uint32_t>();
    hello.max_chunk_count = reader.number<std::uint32_t>();
    return hello;
}

void write_sizes(binary::Writer& writer, const Hello& hello)
{
    writer.number(hello.protocol_version);
    writer.number(hello.receive_buffer_size);
    writer.number(hello.send_buffer_size);
    writer.number(hello.max_message_size);
    writer.number(hello.max_chunk_count);
}

/// Writes header and body of an unsecured message; `encode` writes no more than max_early_size.
template <typename Encode>
void write_message(OutputBuffer& output, MessageType type, Encode&& encode)
{
    const auto room = output.reserve(max_early_size);
    binary::SpanSink sink{room.subspan(header_size)};
    binary::Writer writer{sink};
    encode(writer);
    const std::size_t size = header_size + writer.written();
    write_frame_header(room, {type, 'F', static_cast<std::uint32_t>(size)});
    output.commit(size);
}

String url(std::string_view text)
{
    return String{text.substr(0, max_url_size)};
}

} // namespace

Result<FrameHeader> parse_frame_header(std::span<const std::byte> bytes, std::uint32_t max_size)
{
    const std::string_view name{reinterpret_cast<const char*>(bytes.data()), 3};
    const auto found = std::find(type_names.begin(), type_names.end(), name);
    if (found == type_names.end()) {
        return fail(status::Bad_TcpMessageTypeInvalid);
    }
    FrameHeader header;
    header.type = static_cast<MessageType>(found - type_names.begin());
    header.chunk = static_cast<char>(bytes[3]);
    binary::Reader reader{bytes.subspan(4, 4)};
    header.size = reader.number<std::uint32_t>();
    if (!is_chunk_flag(header.type, header.chunk) || header.size < header_size) {
        return fail(status::Bad_TcpMessageTypeInvalid);
    }
    if (header.size > max_size) {
        return fail(status::Bad_TcpMessageTooLarge);
    }
    return header;
}

void write_frame_header(std::span<std::byte> to, const FrameHeader& header)
{
    binary::SpanSink sink{to.first(header_size)};
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{type_names[static_cast<std::size_t>(header.type)]}));
    writer.number(header.chunk);
    writer.number(header.size);
}

Result<Hello> parse_hello(std::span<const std::byte> body)
{
    auto reader = body_reader(body);
    Hello hello = read_sizes(reader);
    decode(reader, hello.endpoint_url);
    if (reader.status() == status::Bad_EncodingLimitsExceeded) {
        return fail(status::Bad_TcpEndpointUrlInvalid); // Part 6, 7.1.2.3
    }
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_DecodingError);
    }
    return hello;
}

Result<Hello> parse_acknowledge(std::span<const std::byte> body)
{
    auto reader = body_reader(body);
    const Hello acknowledge = read_sizes(reader);
    if (!reader.ok()) {
        return fail(status::Bad_DecodingError);
    }
    return acknowledge;
}

void write_hello(OutputBuffer& output, const Hello& hello)
{
    write_message(output, MessageType::HEL, [&](binary::Writer& writer) {
        write_sizes(writer, hello);
        encode(writer, hello.endpoint_url);
    });
}

void write_acknowledge(OutputBuffer& output, const Hello& acknowledge)
{
    write_message(output, MessageType::ACK,
                  [&](binary::Writer& writer) { write_sizes(writer, acknowledge); });
}

Result<ErrorMessage> parse_error(std::span<const std::byte> body)
{
    auto reader = body_reader(body);
    ErrorMessage message;
    decode(reader, message.error);
    if (!reader.ok()) {
        return fail(status::Bad_DecodingError);
    }
    decode(reader, message.reason);
    if (!reader.ok()) {
        message.reason = {}; // more than 4096 bytes is ignored (Part 6, 7.1.2.5)
    }
    return message;
}

void write_error(OutputBuffer& output, StatusCode error, std::string_view reason)
{
    write_message(output, MessageType::ERR, [&](binary::Writer& writer) {
        encode(writer, error);
        encode(writer, url(reason));
    });
}

Result<ReverseHello> parse_reverse_hello(std::span<const std::byte> body)
{
    auto reader = body_reader(body);
    ReverseHello message;
    decode(reader, message.server_uri);
    decode(reader, message.endpoint_url);
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_TcpEndpointUrlInvalid);
    }
    return message;
}

void write_reverse_hello(OutputBuffer& output, std::string_view server_uri,
                         std::string_view endpoint_url)
{
    write_message(output, MessageType::RHE, [&](binary::Writer& writer) {
        encode(writer, url(server_uri));
        encode(writer, url(endpoint_url));
    });
}

} // namespace busbar::channel::detail
