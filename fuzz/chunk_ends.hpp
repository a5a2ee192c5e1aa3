#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/types/secure_channel.hpp>

#include "channel/conversation.hpp"
#include "require.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

/// The receiving ends of an open channel, and chunks for them as a peer makes them that keeps to no
/// rule but the form.
namespace busbar::fuzz {

using namespace channel::detail;
using channel::ChannelEvent;
using channel::detail::Frame;
using Bytes = std::vector<std::byte>;
using Kind = ChannelEvent::Kind;

inline constexpr std::uint32_t channel_id = 77;
inline constexpr std::uint32_t token_id = 5;
inline constexpr std::size_t max_message_size = 5'000;
inline constexpr std::size_t budget_size = 4'000;
inline constexpr channel::TransportLimits limits{.receive_buffer_size = channel::min_buffer_size,
                                                 .send_buffer_size = channel::min_buffer_size,
                                                 .max_message_size = max_message_size,
                                                 .max_chunk_count = 4};

/// What all ends have around them.
struct World {
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random, .wall_clock = &wall_clock, .log = &log, .budget = &budget};
    }

    test::SeededRandom random;
    test::FixedWallClock wall_clock;
    NullLog log;
    channel::AssemblyBudget budget{budget_size};
};

struct Chunk {
    MessageType type{MessageType::MSG};
    char flag{'F'};
    std::uint32_t channel{channel_id};
    std::uint32_t token{token_id};
    std::uint32_t sequence{0};
    std::uint32_t request{0};
    Bytes body;
};

inline Bytes written(OutputBuffer& out)
{
    return {out.output().begin(), out.output().end()};
}

template <typename T>
Bytes open_message(const T& structure, std::uint32_t channel, std::uint32_t sequence)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, structure);
    const Bytes body = sink.take(writer.written());
    OutputBuffer out;
    require(seal_asymmetric(out,
                            {channel, &crypto::policy_none(), nullptr, nullptr, sequence, 1, body},
                            channel::min_buffer_size)
                .has_value());
    return written(out);
}

/// A server's channel of policy None, opened with an OPN of the sequence number `first`.
struct ServerEnd {
    ServerEnd(World& world, std::uint32_t first)
        : engine{{.limits = limits, .allowed = {{}}, .channel_id = channel_id},
                 world.environment(),
                 {}}
    {
        OutputBuffer out;
        write_hello(out, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://localhost"}});
        static_cast<void>(engine.feed(out.output(), {}));
        OpenSecureChannelRequest request;
        request.security_mode = MessageSecurityMode::None;
        static_cast<void>(engine.feed(open_message(request, 0, first), {}));
        const auto opened = engine.next_event();
        require(opened && opened->kind == Kind::Opened);
        engine.consume(engine.output().size());
    }

    static constexpr bool is_server = true;
    /// Of the tokens that a server issues, the first.
    static constexpr std::uint32_t token = 1;
    channel::ServerChannel engine;
};

/// A client's, likewise.
struct ClientEnd {
    ClientEnd(World& world, std::uint32_t first) : engine{config(), world.environment(), {}}
    {
        OutputBuffer out;
        write_acknowledge(out, {0, 65'535, 65'535, 0, 0, {}});
        static_cast<void>(engine.feed(out.output(), {}));
        require(!engine.next_event());
        OpenSecureChannelResponse response;
        response.security_token = {channel_id, token_id, {}, 60'000};
        static_cast<void>(engine.feed(open_message(response, channel_id, first), {}));
        const auto opened = engine.next_event();
        require(opened && opened->kind == Kind::Opened);
        engine.consume(engine.output().size());
    }

    [[nodiscard]] static channel::ClientChannelConfig config()
    {
        channel::ClientChannelConfig config;
        config.limits = limits;
        config.endpoint_url = "opc.tcp://localhost";
        return config;
    }

    static constexpr bool is_server = false;
    static constexpr std::uint32_t token = token_id;
    channel::ClientChannel engine;
};

inline channel::SecuritySetting secured(bool is_encrypted)
{
    return {crypto::find_policy_by_name("Basic256Sha256"),
            is_encrypted ? MessageSecurityMode::SignAndEncrypt : MessageSecurityMode::Sign};
}

inline Token token_of(const channel::SecuritySetting& setting, bool is_receiver)
{
    static const Bytes receiver(32, std::byte{1});
    static const Bytes sender(32, std::byte{2});
    const Nonces nonces = is_receiver ? Nonces{receiver, sender} : Nonces{sender, receiver};
    auto token = make_token(token_id, setting, nonces, std::chrono::hours{1}, {});
    require(token.has_value());
    return *std::move(token);
}

/// What both channels do with chunks, with keys that nobody had to agree on.
class SecuredConversation {
public:
    SecuredConversation(World& world, bool is_encrypted, std::uint32_t first)
        : conversation_{limits, world.environment(), Role::Client}
    {
        conversation_.security = secured(is_encrypted);
        conversation_.channel_id = channel_id;
        conversation_.max_frame_size = limits.receive_buffer_size;
        conversation_.use(token_of(conversation_.security, true));
        require(conversation_.accept_sequence(first));
    }

    [[nodiscard]] Result<void> feed(std::span<const std::byte> bytes, TimePoint)
    {
        conversation_.feed(bytes);
        return {};
    }
    [[nodiscard]] std::optional<ChannelEvent> next_event()
    {
        while (!is_closed_) {
            const auto frame = conversation_.next_frame();
            if (frame && !*frame) {
                break;
            }
            auto event = frame ? handle(**frame) : fail(frame.error());
            if (!event) {
                is_closed_ = true;
                return ChannelEvent{Kind::Closed, 0, {}, event.error(), {}};
            }
            if (*event) {
                return *std::move(event);
            }
        }
        return std::nullopt;
    }
    void recycle(Bytes body) { conversation_.assembly().recycle(std::move(body)); }
    [[nodiscard]] std::size_t memory_in_use() const { return conversation_.memory_in_use(); }
    [[nodiscard]] static std::span<const std::byte> output() { return {}; }
    void consume(std::size_t) {}

private:
    [[nodiscard]] Result<std::optional<ChannelEvent>> handle(const Frame& frame)
    {
        if (frame.header.type != MessageType::MSG) {
            return fail(status::Bad_TcpMessageTypeInvalid);
        }
        const auto content = conversation_.open(frame, {});
        return content ? conversation_.assembly().add(frame.header.chunk, *content)
                       : fail(content.error());
    }

    Conversation conversation_;
    bool is_closed_{false};
};

struct SecuredEnd {
    SecuredEnd(World& world, bool is_encrypted, std::uint32_t first)
        : setting{secured(is_encrypted)}, sender{token_of(setting, false)}, engine{world,
                                                                                   is_encrypted,
                                                                                   first}
    {
    }

    static constexpr bool is_server = false;
    static constexpr std::uint32_t token = token_id;
    channel::SecuritySetting setting;
    Token sender;
    SecuredConversation engine;
};

/// The chunk as a sender without security writes it.
inline Bytes plain(const Chunk& chunk)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint64_t{0});
    for (const std::uint32_t number : {chunk.channel, chunk.token, chunk.sequence, chunk.request}) {
        writer.number(number);
    }
    writer.bytes(chunk.body);
    Bytes bytes = sink.take(writer.written());
    write_frame_header(bytes, {chunk.type, chunk.flag, static_cast<std::uint32_t>(bytes.size())});
    return bytes;
}

template <typename End>
Bytes sealed(End&, const Chunk& chunk)
{
    return plain(chunk);
}

/// Padded, signed and encrypted (Part 6, 6.7.2.5).
inline Bytes sealed(SecuredEnd& end, const Chunk& chunk)
{
    Bytes bytes = plain(chunk);
    const auto& policy = *end.setting.policy;
    const std::size_t signature = policy.symmetric_signature_size;
    const bool is_encrypted = end.setting.mode == MessageSecurityMode::SignAndEncrypt;
    if (is_encrypted) {
        const std::size_t used = bytes.size() - symmetric_header_size + 1 + signature;
        const std::size_t padding =
            (policy.block_size - used % policy.block_size) % policy.block_size;
        bytes.insert(bytes.end(), padding + 1, static_cast<std::byte>(padding));
    }
    const std::size_t end_of_content = bytes.size();
    bytes.resize(end_of_content + signature);
    write_frame_header(bytes, {chunk.type, chunk.flag, static_cast<std::uint32_t>(bytes.size())});
    const std::span<std::byte> all{bytes};
    require(end.sender.send->sign(all.first(end_of_content), all.subspan(end_of_content)));
    require(!is_encrypted || end.sender.send->encrypt(all.subspan(symmetric_header_size)));
    return bytes;
}

} // namespace busbar::fuzz
