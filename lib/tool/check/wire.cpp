#include "wire.hpp"

#include <asio/connect.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/types/discovery.hpp>

#include "requests.hpp"

namespace busbar::tool::rules {

namespace {

/// More than any buffer that a rule asks for.
constexpr std::uint32_t max_chunk_size = 1U << 20U;

template <typename T>
Bytes encoded_structure(const T& structure)
{
    return bytes_of([&](binary::Writer& writer) {
        encode(writer, NodeId{0, T::binary_encoding_id});
        encode(writer, structure);
    });
}

} // namespace

struct Wire::Impl {
    asio::io_context context;
    asio::ip::tcp::socket socket{context};

    /// Carries one operation out; the error is `would_block` if the time was over.
    template <typename Start>
    std::error_code wait(Duration time, Start start)
    {
        std::error_code result = asio::error::would_block;
        start([&result](std::error_code error, auto&&...) { result = error; });
        context.restart();
        context.run_for(time);
        if (result == asio::error::would_block) {
            std::error_code ignored;
            socket.close(ignored);
            context.restart();
            context.poll();
            return asio::error::would_block;
        }
        return result;
    }
};

Bytes bytes_of(FunctionRef<void(binary::Writer&)> encode)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer);
    return sink.take(writer.written());
}

std::uint32_t RawChunk::number(std::size_t offset) const
{
    binary::Reader reader{std::span{body}.subspan(std::min(offset, body.size()))};
    return reader.number<std::uint32_t>();
}

Wire::Wire(const Subject& subject) : subject_{&subject}, impl_{std::make_unique<Impl>()}
{
    const auto url = channel::EndpointUrl::parse(subject.config().channel.endpoint_url);
    if (!url) {
        throw Unreachable{url.error()};
    }
    std::error_code error;
    asio::ip::tcp::resolver resolver{impl_->context};
    const auto addresses = resolver.resolve(url->host, std::to_string(url->port), error);
    if (!error) {
        error = impl_->wait(subject.limit().left(), [&](auto done) {
            asio::async_connect(impl_->socket, addresses, done);
        });
    }
    if (error) {
        throw Unreachable{status::Bad_CommunicationError};
    }
}

Wire::Wire(Wire&&) noexcept = default;
Wire::~Wire() = default;

void Wire::send(std::span<const std::byte> bytes)
{
    // If the server has closed the connection, receive() finds that.
    static_cast<void>(impl_->wait(subject_->limit().left(), [&](auto done) {
        asio::async_write(impl_->socket, asio::buffer(bytes.data(), bytes.size()), done);
    }));
}

void Wire::send(std::string_view type, std::span<const std::byte> body)
{
    send(bytes_of([&](binary::Writer& writer) {
        writer.bytes(std::as_bytes(std::span{type}));
        encode(writer, static_cast<std::uint32_t>(8 + body.size()));
        writer.bytes(body);
    }));
}

std::optional<RawChunk> Wire::receive()
{
    const auto read = [&](std::span<std::byte> bytes) {
        const std::error_code error = impl_->wait(subject_->limit().left(), [&](auto done) {
            asio::async_read(impl_->socket, asio::buffer(bytes.data(), bytes.size()), done);
        });
        if (error == asio::error::would_block) {
            static_cast<void>(subject_->limit().left());
            throw NoAnswer{status::Bad_Timeout, "no answer in time"};
        }
        return !error;
    };
    std::array<std::byte, 8> header;
    if (!read(header)) {
        return std::nullopt;
    }
    RawChunk chunk;
    for (std::size_t i = 0; i < 4; ++i) {
        chunk.type += static_cast<char>(header[i]);
    }
    binary::Reader reader{std::span{header}.subspan(4)};
    const auto size = reader.number<std::uint32_t>();
    if (size < header.size() || size > max_chunk_size) {
        throw NoAnswer{status::Bad_TcpMessageTooLarge,
                       "a chunk of " + std::to_string(size) + " bytes"};
    }
    chunk.body.resize(size - header.size());
    return read(chunk.body) ? std::optional{std::move(chunk)} : std::nullopt;
}

Answer Wire::refusal()
{
    const auto chunk = receive();
    if (!chunk) {
        return came(status::Bad_ConnectionClosed);
    }
    return chunk->type == "ERRF" ? came(StatusCode{chunk->number(0)})
                                 : wrong("a chunk " + chunk->type);
}

std::optional<RawChunk> Wire::hello(const HelloForm& form)
{
    send("HELF", bytes_of([&](binary::Writer& writer) {
             for (const std::uint32_t number : {form.version, form.buffer_size, form.buffer_size,
                                                form.max_message_size, form.max_chunk_count}) {
                 encode(writer, number);
             }
             encode(writer,
                    String{form.url.empty() ? subject_->config().channel.endpoint_url : form.url});
         }));
    return receive();
}

RawChannel::RawChannel(const Subject& subject, const HelloForm& form) : wire_{subject}
{
    auto answer = wire_.hello(form);
    if (!answer || answer->type != "ACKF") {
        throw Refused{answer && answer->type == "ERRF" ? StatusCode{answer->number(0)}
                                                       : StatusCode{status::Bad_ConnectionClosed},
                      "Hello"};
    }
    acknowledge_ = *std::move(answer);
    wire_.send("OPNF", open_request(SecurityTokenRequestType::Issue));
    if (const auto opened = take_token(wire_.receive()); !opened) {
        throw Refused{opened.error(), "OpenSecureChannel"};
    }
}

Bytes RawChannel::open_request(SecurityTokenRequestType type,
                               const std::function<void(OpenSecureChannelRequest&)>& change,
                               std::string_view policy, std::uint32_t channel_id)
{
    OpenSecureChannelRequest request;
    request.request_type = type;
    request.security_mode = MessageSecurityMode::None;
    request.requested_lifetime = 3'600'000;
    request.request_header.timestamp = subject_time();
    if (change) {
        change(request);
    }
    return bytes_of([&](binary::Writer& writer) {
        encode(writer, channel_id != 0 ? channel_id : token_.channel_id);
        encode(writer, String{policy.empty() ? crypto::policy_none().uri : policy});
        encode(writer, ByteString{});
        encode(writer, ByteString{});
        encode(writer, ++sequence_number_);
        encode(writer, ++request_id_);
        writer.bytes(encoded_structure(request));
    });
}

DateTime RawChannel::subject_time() const
{
    return wire_.subject().environment().wall_clock->now();
}

Bytes RawChannel::message(std::span<const std::byte> body, std::uint32_t number,
                          std::uint32_t token_id, std::uint32_t channel_id)
{
    return bytes_of([&](binary::Writer& writer) {
        encode(writer, channel_id != 0 ? channel_id : token_.channel_id);
        encode(writer, token_id != 0 ? token_id : token_.token_id);
        encode(writer, number != 0 ? number : ++sequence_number_);
        encode(writer, request_id_);
        writer.bytes(body);
    });
}

Bytes RawChannel::some_request(std::uint32_t handle) const
{
    GetEndpointsRequest request;
    request.request_header.timestamp = subject_time();
    request.request_header.request_handle = handle;
    request.endpoint_url = wire_.subject().config().channel.endpoint_url;
    return encoded_structure(request);
}

std::optional<RawChunk> RawChannel::ask()
{
    ++request_id_;
    wire_.send("MSGF", message(some_request()));
    return wire_.receive();
}

Result<OpenSecureChannelResponse> RawChannel::take_token(const std::optional<RawChunk>& chunk)
{
    if (!chunk) {
        return fail(status::Bad_ConnectionClosed);
    }
    if (chunk->type != "OPNF") {
        return fail(chunk->type == "ERRF" ? StatusCode{chunk->number(0)}
                                          : StatusCode{status::Bad_TcpMessageTypeInvalid});
    }
    binary::Reader reader{chunk->body};
    static_cast<void>(reader.number<std::uint32_t>());
    String policy;
    ByteString bytes;
    decode(reader, policy);
    decode(reader, bytes);
    decode(reader, bytes);
    reader.skip(8);
    auto response = client::decode_response<OpenSecureChannelResponse>(
        std::span{chunk->body}.subspan(reader.offset()), binary::Strings::Own,
        client::response_limits);
    if (response) {
        token_ = response->security_token;
        return response;
    }
    const auto fault =
        client::decode_response<ServiceFault>(std::span{chunk->body}.subspan(reader.offset()),
                                              binary::Strings::Own, client::response_limits);
    return fail(fault ? fault->response_header.service_result : response.error());
}

} // namespace busbar::tool::rules
