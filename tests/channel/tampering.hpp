#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <busbar/channel/client_channel.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/secure_channel.hpp>

#include "channel/conversation.hpp"
#include "channel/remembered_rsa.hpp"
#include "support/byte_pipe.hpp"
#include "support/channel_pair.hpp"

/// Channels one end of which is made by the test, which knows all keys and can say anything.
namespace busbar::test {

using Bytes = std::vector<std::byte>;

/// Every policy but None in every mode.
[[nodiscard]] inline std::vector<channel::SecuritySetting> all_settings()
{
    std::vector<channel::SecuritySetting> settings;
    for (const auto& policy : crypto::security_policies().subspan(1)) {
        settings.push_back({&policy, MessageSecurityMode::Sign});
        settings.push_back({&policy, MessageSecurityMode::SignAndEncrypt});
    }
    return settings;
}

/// A server that has its asymmetric work done elsewhere.
struct WorkedServerChannel : channel::ServerChannel {
    using ServerChannel::ServerChannel;
};

/// The end under test. Its random numbers repeat, so that what opened one of these opens all.
template <typename Engine>
struct Subject {
    static constexpr bool is_server = std::is_base_of_v<channel::ServerChannel, Engine>;
    static constexpr bool has_worker = std::is_same_v<Engine, WorkedServerChannel>;

    explicit Subject(const channel::SecuritySetting& security) : engine{make(security)} {}

    void feed(const Bytes& bytes)
    {
        static_cast<void>(engine.feed(bytes, now));
        poll();
    }
    void advance(Duration time)
    {
        now += time;
        engine.handle_deadline(now);
        poll();
    }
    [[nodiscard]] std::size_t count(channel::ChannelEvent::Kind kind) const
    {
        return static_cast<std::size_t>(std::count_if(
            events.begin(), events.end(), [&](const auto& event) { return event.kind == kind; }));
    }
    /// Why it closed, for its owner; Good while it has not.
    [[nodiscard]] StatusCode reason() const
    {
        return engine.is_closed() && !events.empty() ? events.back().status : StatusCode{};
    }

    TimePoint now{};
    SeededRandom random{is_server ? 11U : 22U};
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    HandWorker worker;
    std::vector<channel::ChannelEvent> events;
    Engine engine;

private:
    void poll()
    {
        while (auto event = engine.next_event()) {
            events.push_back(*std::move(event));
        }
        if constexpr (has_worker) {
            if (worker.finish(engine, now)) {
                poll();
            }
        }
    }
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random,
                .wall_clock = &wall_clock,
                .log = &log,
                .validator = &validator,
                .identity = is_server ? &server_identity() : &client_identity(),
                .worker = has_worker ? &worker : nullptr};
    }
    [[nodiscard]] Engine make(const channel::SecuritySetting& security)
    {
        if constexpr (is_server) {
            channel::ServerChannelConfig config;
            config.allowed = all_settings();
            config.channel_id = 77;
            return Engine{config, environment(), now};
        } else {
            channel::ClientChannelConfig config;
            config.security = security;
            config.server_certificate = server_identity().certificates.front();
            return Engine{config, environment(), now};
        }
    }
};

/// The other end: says what the test wants, right unless the test wants it wrong.
template <typename Engine>
class Script {
public:
    static constexpr bool is_client = Subject<Engine>::is_server;
    static constexpr std::uint32_t channel_id = 77;

    explicit Script(const channel::SecuritySetting& setting) : security{setting} {}

    [[nodiscard]] static Bytes greeting()
    {
        channel::detail::OutputBuffer out;
        if (is_client) {
            channel::detail::write_hello(out, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://plc"}});
        } else {
            channel::detail::write_acknowledge(out, {0, 65'535, 65'535, 0, 0, {}});
        }
        return bytes_of(out);
    }
    /// An OPN, Issue or Renew, whose nonce is made of `fill`. It has the next sequence number.
    [[nodiscard]] Bytes open(bool is_renewal, std::uint8_t fill)
    {
        own_nonce = Bytes(security.policy->nonce_size + nonce_excess, static_cast<std::byte>(fill));
        binary::VectorSink sink;
        binary::Writer writer{sink};
        if (is_client) {
            OpenSecureChannelRequest request;
            request.request_type =
                is_renewal ? SecurityTokenRequestType::Renew : SecurityTokenRequestType::Issue;
            request.security_mode = security.mode;
            request.client_nonce = ByteString{own_nonce};
            request.requested_lifetime = 60'000;
            channel::detail::encode_message(writer, request);
        } else {
            OpenSecureChannelResponse response;
            response.security_token.channel_id = channel_id;
            response.security_token.token_id = ++token_id;
            response.security_token.revised_lifetime = 60'000;
            response.server_nonce = ByteString{own_nonce};
            channel::detail::encode_message(writer, response);
        }
        const Bytes body = sink.take(writer.written());
        channel::detail::OutputBuffer out;
        const bool has_id = !is_client || is_renewal;
        REQUIRE(channel::detail::seal_asymmetric(out,
                                                 {has_id ? channel_id : 0, security.policy, &own(),
                                                  &peer().certificates.front(), ++sequence,
                                                  is_client ? sequence : request_id, body},
                                                 65'535));
        return bytes_of(out);
    }
    /// Reads nonce and ids from the OPN that is last in the subject's output.
    void listen(Engine& engine)
    {
        for (Bytes rest = take_output(engine); !rest.empty();) {
            const auto header = channel::detail::parse_frame_header(rest, 65'535);
            REQUIRE(header);
            if (header->type == channel::detail::MessageType::OPN) {
                read_open(std::span{rest}.first(header->size));
            }
            rest.erase(rest.begin(), rest.begin() + header->size);
        }
    }
    /// After both OPN: makes the keys.
    void agree()
    {
        auto made = channel::detail::make_token(token_id, security, {own_nonce, peer_nonce},
                                                std::chrono::minutes{1}, {});
        REQUIRE(made);
        token = *std::move(made);
    }
    /// One message in chunks of at most `chunk_size` bytes; the members say what they carry.
    [[nodiscard]] Bytes message(channel::detail::MessageType type, std::size_t body_size = 12,
                                std::uint32_t chunk_size = 8'192)
    {
        channel::detail::OutputBuffer out;
        channel::detail::SequenceNumbers numbers;
        numbers.reset_to(sequence);
        channel::detail::ChunkSink sink{out,
                                        token,
                                        numbers,
                                        {type, sent_channel_id, 3, security, chunk_size, 65'535, 99,
                                         status::Bad_RequestTooLarge}};
        binary::Writer writer{sink};
        writer.bytes(Bytes(body_size, std::byte{0x5A}));
        REQUIRE(writer.ok());
        REQUIRE(sink.finish(writer.filled()));
        sequence = numbers.last();
        return bytes_of(out);
    }
    /// `chunk` with its text decrypted, changed, signed and encrypted again.
    template <typename Change>
    [[nodiscard]] Bytes resealed(Bytes chunk, Change change)
    {
        using channel::detail::symmetric_header_size;
        const std::span all{chunk};
        const std::size_t end = chunk.size() - security.policy->symmetric_signature_size;
        const bool is_encrypted = security.mode == MessageSecurityMode::SignAndEncrypt;
        REQUIRE((!is_encrypted || token.send->decrypt(all.subspan(symmetric_header_size))));
        change(all.first(end));
        REQUIRE(token.send->sign(all.first(end), all.subspan(end)));
        REQUIRE((!is_encrypted || token.send->encrypt(all.subspan(symmetric_header_size))));
        return chunk;
    }
    [[nodiscard]] Bytes message_numbered(std::uint32_t number)
    {
        return resealed(message(channel::detail::MessageType::MSG), [&](std::span<std::byte> text) {
            for (unsigned i = 0; i < 4; ++i) {
                text[channel::detail::symmetric_header_size + i] =
                    static_cast<std::byte>(number >> (8 * i));
            }
        });
    }
    [[nodiscard]] static const channel::ApplicationIdentity& own()
    {
        return is_client ? client_identity() : server_identity();
    }
    [[nodiscard]] static const channel::ApplicationIdentity& peer()
    {
        return is_client ? server_identity() : client_identity();
    }

    channel::SecuritySetting security;
    std::uint32_t sequence{0}; // of the chunk sent last
    std::uint32_t sent_channel_id{channel_id};
    std::uint32_t token_id{0};
    std::uint32_t request_id{0};
    std::size_t nonce_excess{0}; // of bytes; what wraps makes a nonce shorter
    channel::detail::Token token;
    Bytes own_nonce;
    Bytes peer_nonce;

private:
    [[nodiscard]] static Bytes bytes_of(const channel::detail::OutputBuffer& out)
    {
        return {out.output().begin(), out.output().end()};
    }
    void read_open(std::span<const std::byte> message)
    {
        const auto header = channel::detail::parse_asymmetric_header(message);
        REQUIRE(header);
        const auto content = channel::detail::open_asymmetric(message, *header, &own().key,
                                                              &peer().certificates.front());
        REQUIRE(content);
        request_id = content->request_id;
        if constexpr (is_client) {
            const auto response =
                channel::detail::decode_message<OpenSecureChannelResponse>(content->body);
            REQUIRE(response);
            token_id = response->security_token.token_id;
            const auto nonce = response->server_nonce.span();
            peer_nonce.assign(nonce.begin(), nonce.end());
        } else {
            const auto request =
                channel::detail::decode_message<OpenSecureChannelRequest>(content->body);
            REQUIRE(request);
            const auto nonce = request->client_nonce.span();
            peer_nonce.assign(nonce.begin(), nonce.end());
        }
    }
};

/// Tells how far a subject's channel is.
enum class Stage { Greeted, Open, Renewing };

/// A channel that was opened once; with the same bytes any number of subjects can be opened.
template <typename Engine>
struct Recording {
    explicit Recording(const channel::SecuritySetting& setting, std::uint32_t first_sequence = 1)
        : script{setting}
    {
        script.sequence = first_sequence - 1;
        Subject<Engine> first{setting};
        opening.push_back(script.greeting());
        first.feed(opening.back());
        script.listen(first.engine);
        opening.push_back(script.open(false, 1));
        first.feed(opening.back());
        REQUIRE(first.engine.is_open());
        script.listen(first.engine);
        script.agree();
    }
    /// Brings a new subject to that stage, with nothing left over.
    void bring(Subject<Engine>& subject, Stage stage) const
    {
        subject.feed(opening[0]);
        if (stage != Stage::Greeted) {
            subject.feed(opening[1]);
        }
        if (stage == Stage::Renewing && !Subject<Engine>::is_server) {
            subject.advance(std::chrono::seconds{46}); // a client asks by itself
        }
        static_cast<void>(take_output(subject.engine));
        subject.events.clear();
    }
    /// The OPN that a subject of that stage waits for.
    [[nodiscard]] Bytes awaited_open(Stage stage)
    {
        if (stage == Stage::Greeted) {
            return opening[1];
        }
        Subject<Engine> subject{script.security};
        bring(subject, Stage::Open);
        if (!Subject<Engine>::is_server) {
            subject.advance(std::chrono::seconds{46});
            script.listen(subject.engine);
        }
        return script.open(true, 2);
    }

    Script<Engine> script;
    std::vector<Bytes> opening;
    RememberedRsa rsa; // of all that is opened with this
};

/// Tells what a server answers; nothing else than the status can be told from it.
[[nodiscard]] inline Bytes answer_with(StatusCode status)
{
    channel::detail::OutputBuffer out;
    channel::detail::write_error(out, status, name(status));
    return {out.output().begin(), out.output().end()};
}

/// The subject gave nothing to its owner and closed for `status`; a server said `told`.
template <typename Engine>
void check_refused(Subject<Engine>& subject, StatusCode status,
                   StatusCode told = status::Bad_SecurityChecksFailed)
{
    CHECK(subject.engine.is_closed());
    CHECK(subject.events.size() == 1); // Closed
    CHECK(subject.reason() == status);
    const Bytes answer = take_output(subject.engine);
    if (Subject<Engine>::is_server) {
        CHECK(answer == answer_with(told));
    } else if (!answer.empty()) {
        CHECK(answer[0] == std::byte{'C'}); // CloseSecureChannel
    }
}

[[nodiscard]] inline Bytes flipped(Bytes bytes, std::size_t at)
{
    bytes[at] ^= std::byte{0x10};
    return bytes;
}

} // namespace busbar::test
