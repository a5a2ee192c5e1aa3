#pragma once

#include <vector>

#include <busbar/types/secure_channel.hpp>

#include "channel/conversation.hpp"
#include "support/channel_pair.hpp"

namespace busbar::test {

/// A certificate validator that says what it is told to.
class FixedValidator final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain&,
                                         const crypto::ValidationContext&) override
    {
        if (answer.is_bad()) {
            return refuse({answer, "the validator's check", "what the test wants", "a test", {}});
        }
        return {};
    }

    StatusCode answer;
};

/// A server channel whose client sends what the test writes: the protocol's messages with any
/// content, right by default.
class ScriptedClient {
public:
    using Bytes = std::vector<std::byte>;

    /// What an OpenSecureChannel says.
    struct Open {
        std::uint32_t channel_id{0};
        const channel::ApplicationIdentity* sender{&client_identity()};
        const crypto::Certificate* receiver{&server_identity().certificates.front()};
        channel::SecuritySetting security;
        SecurityTokenRequestType type{SecurityTokenRequestType::Issue};
        std::size_t nonce_size{32};
        std::uint8_t nonce_fill{1};
        /// Bytes behind the request that belong to nothing; negative: of the request that are
        /// missing.
        std::ptrdiff_t surplus{0};
    };

    explicit ScriptedClient(std::vector<channel::SecuritySetting> allowed,
                            channel::TransportLimits limits = {},
                            channel::SpareBuffers* spares = nullptr,
                            crypto::KnownCertificates* known = nullptr)
        : server{config(std::move(allowed), limits, spares, known),
                 {.random = &random,
                  .wall_clock = &wall_clock,
                  .log = &log,
                  .validator = &validator,
                  .identity = &server_identity(),
                  .budget = &budget},
                 now}
    {
        channel::detail::OutputBuffer out;
        channel::detail::Hello hello{0, 65'535, 65'535, 0, 0, String{"opc.tcp://localhost:4840"}};
        channel::detail::write_hello(out, hello);
        feed({out.output().begin(), out.output().end()});
        server.consume(server.output().size()); // the Acknowledge
    }

    void feed(const Bytes& bytes)
    {
        static_cast<void>(server.feed(bytes, now));
        while (auto event = server.next_event()) {
            events.push_back(*std::move(event));
        }
    }
    [[nodiscard]] Bytes open_message(const Open& open)
    {
        OpenSecureChannelRequest request;
        request.request_type = open.type;
        request.security_mode = open.security.mode;
        request.client_nonce =
            ByteString{Bytes(open.nonce_size, static_cast<std::byte>(open.nonce_fill))};
        request.requested_lifetime = 60'000;
        binary::VectorSink sink;
        binary::Writer writer{sink};
        channel::detail::encode_message(writer, request);
        Bytes body = sink.take(writer.written());
        body.resize(
            static_cast<std::size_t>(static_cast<std::ptrdiff_t>(body.size()) + open.surplus));
        channel::detail::OutputBuffer out;
        REQUIRE(
            channel::detail::seal_asymmetric(out,
                                             {open.channel_id, open.security.policy, open.sender,
                                              open.receiver, ++sequence, sequence, body},
                                             1U << 20U));
        return {out.output().begin(), out.output().end()};
    }
    /// A MSG or CLO chunk of a channel with policy None.
    [[nodiscard]] Bytes chunk(std::string_view type_and_flag, std::uint32_t request_id,
                              std::size_t body_size, std::uint32_t token_id = 1)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        writer.bytes(std::as_bytes(std::span{type_and_flag}));
        writer.number(static_cast<std::uint32_t>(24 + body_size));
        for (const std::uint32_t number : {channel_id, token_id, ++sequence, request_id}) {
            writer.number(number);
        }
        writer.bytes(Bytes(body_size));
        return sink.take(writer.written());
    }
    /// The Error message that the server sent last; empty if it sent none.
    [[nodiscard]] Bytes error() const
    {
        Bytes last;
        auto rest = server.output();
        while (rest.size() >= 8) {
            binary::Reader reader{rest.subspan(4)};
            const std::size_t size = reader.number<std::uint32_t>();
            if (rest[0] == std::byte{'E'}) {
                last.assign(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
            }
            rest = rest.subspan(size);
        }
        return last;
    }
    [[nodiscard]] StatusCode told() const
    {
        const Bytes message = error();
        binary::Reader reader{message};
        reader.skip(8);
        return StatusCode{reader.number<std::uint32_t>()};
    }
    /// Why the server closed, as its owner learns it; Good while it has not.
    [[nodiscard]] StatusCode reason() const
    {
        return events.empty() ? StatusCode{} : events.back().status;
    }

    static constexpr std::uint32_t channel_id = 77;
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    FixedValidator validator;
    channel::AssemblyBudget budget{1U << 20U};
    TimePoint now{};
    std::uint32_t sequence{0};
    std::vector<channel::ChannelEvent> events;
    channel::ServerChannel server;

private:
    [[nodiscard]] static channel::ServerChannelConfig
    config(std::vector<channel::SecuritySetting> allowed, channel::TransportLimits limits,
           channel::SpareBuffers* spares, crypto::KnownCertificates* known)
    {
        channel::ServerChannelConfig config;
        config.limits = limits;
        config.allowed = std::move(allowed);
        config.channel_id = channel_id;
        config.spares = spares;
        config.known_certificates = known;
        return config;
    }
};

} // namespace busbar::test
