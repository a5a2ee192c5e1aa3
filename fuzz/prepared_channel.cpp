#include "prepared_channel.hpp"

#include <map>

#include "require.hpp"

namespace busbar::fuzz {

namespace {

using channel::detail::OpeningWork;
using channel::detail::SealingWork;

channel::ChannelEnvironment environment_of(PreparedPair& pair)
{
    return {.random = &pair.random,
            .wall_clock = &pair.wall_clock,
            .log = &pair.log,
            .validator = &pair.validator,
            .identity = &test::server_identity(),
            .worker = &pair.worker};
}

channel::ServerChannelConfig config_of(const channel::SecuritySetting& security)
{
    static crypto::KnownCertificates known;
    channel::ServerChannelConfig config;
    config.allowed = {security};
    config.channel_id = 77;
    config.known_certificates = &known;
    return config;
}

/// What an OPN in `message` says to the owner of the key.
channel::detail::AsymmetricContent content_of(std::span<const std::byte> message,
                                              const channel::ApplicationIdentity& receiver,
                                              const channel::ApplicationIdentity& sender)
{
    const auto header = channel::detail::parse_asymmetric_header(message);
    require(header.has_value());
    auto content = channel::detail::open_asymmetric(message, *header, &receiver.key,
                                                    &sender.certificates.front());
    require(content.has_value());
    return *std::move(content);
}

/// The work that waits, which is of that kind.
template <typename Work>
Work& waiting(test::HandWorker& worker)
{
    auto* const work = dynamic_cast<Work*>(worker.work.get());
    require(work != nullptr);
    return *work;
}

/// What a real client says to a server that has these random numbers.
Handshake make_handshake(const channel::SecuritySetting& security)
{
    test::ChannelPair pair{security, {}, {}, test::Way::Worker};
    Handshake made;
    made.security = security;
    test::SeededRandom random;
    test::FixedWallClock wall_clock;
    NullLog log;
    channel::ServerChannel server{config_of(security),
                                  {.random = &random,
                                   .wall_clock = &wall_clock,
                                   .log = &log,
                                   .validator = &pair.validator,
                                   .identity = &test::server_identity(),
                                   .worker = &pair.worker},
                                  pair.now};
    const auto to_server = [&] {
        const auto bytes = pair.client.output();
        made.client_bytes.insert(made.client_bytes.end(), bytes.begin(), bytes.end());
        static_cast<void>(server.feed(bytes, pair.now));
        pair.client.consume(bytes.size());
        static_cast<void>(server.next_event());
    };
    to_server(); // Hello
    static_cast<void>(pair.client.feed(server.output(), pair.now));
    server.consume(server.output().size());
    static_cast<void>(pair.client.next_event());
    to_server(); // OpenSecureChannel
    waiting<OpeningWork>(pair.worker).run();
    made.request = waiting<OpeningWork>(pair.worker).opened.value();
    pair.worker.work = nullptr;
    server.work_done({}, pair.now);
    waiting<SealingWork>(pair.worker).run();
    made.answer = waiting<SealingWork>(pair.worker).message.value();
    pair.worker.work = nullptr;
    server.work_done({}, pair.now);

    const auto request =
        channel::detail::decode_message<OpenSecureChannelRequest>(made.request.body);
    const auto response = channel::detail::decode_message<OpenSecureChannelResponse>(
        content_of(made.answer, test::client_identity(), test::server_identity()).body);
    require(request.has_value() && response.has_value());
    made.client_nonce = request->client_nonce;
    made.response = *response;
    return made;
}

} // namespace

const Handshake& Handshake::of(const channel::SecuritySetting& security)
{
    static std::map<MessageSecurityMode, Handshake> made;
    const auto place = made.find(security.mode);
    if (place != made.end()) {
        return place->second;
    }
    return made.emplace(security.mode, make_handshake(security)).first->second;
}

PreparedClient::PreparedClient(const Handshake& handshake,
                               const channel::ChannelEnvironment& environment, TimePoint now)
    : conversation_{{}, environment, channel::detail::Role::Client}
{
    conversation_.security = handshake.security;
    conversation_.negotiate(conversation_.sizes());
    static_cast<void>(conversation_.open_parts(request_id_)); // whose number is taken
    const ChannelSecurityToken& issued = handshake.response.security_token;
    conversation_.channel_id = issued.channel_id;
    auto token = channel::detail::make_token(
        issued.token_id, handshake.security,
        {handshake.client_nonce.span(), handshake.response.server_nonce.span()},
        std::chrono::milliseconds{issued.revised_lifetime}, now);
    require(token.has_value());
    conversation_.use(*std::move(token));
}

Result<void> PreparedClient::send(FunctionRef<void(binary::Writer&)> encode)
{
    return conversation_.send(channel::detail::MessageType::MSG, ++request_id_, encode);
}

void PreparedClient::close()
{
    static_cast<void>(conversation_.send(
        channel::detail::MessageType::CLO, ++request_id_, [](binary::Writer& writer) {
            channel::detail::encode_message(writer, CloseSecureChannelRequest{});
        }));
}

void PreparedClient::take(std::span<const std::byte> bytes, TimePoint now)
{
    conversation_.feed(bytes);
    while (true) {
        const auto frame = conversation_.next_frame();
        require(frame.has_value());
        if (!*frame) {
            return;
        }
        if ((*frame)->header.type == channel::detail::MessageType::MSG) {
            require(conversation_.open(**frame, now).has_value());
        }
    }
}

PreparedPair::PreparedPair(const channel::SecuritySetting& security)
    : server{config_of(security), environment_of(*this), now}, client{Handshake::of(security),
                                                                      environment_of(*this), now}
{
    const Handshake& handshake = Handshake::of(security);
    static_cast<void>(server.feed(handshake.client_bytes, now));
    static_cast<void>(server.next_event());
    waiting<OpeningWork>(worker).opened = handshake.request;
    worker.work = nullptr;
    server.work_done({}, now);
    waiting<SealingWork>(worker).message = handshake.answer;
    worker.work = nullptr;
    server.work_done({}, now);
    require(server.is_open());
    server.consume(server.output().size());
}

void PreparedPair::run()
{
    const auto poll = [this] {
        do {
            while (auto event = server.next_event()) {
                server_events.push_back(*std::move(event));
            }
        } while (worker.finish(server, now));
    };
    static_cast<void>(server.feed(client.output(), now));
    client.consume(client.output().size());
    poll();
    client.take(server.output(), now);
    server.consume(server.output().size());
}

void PreparedPair::advance(Duration time)
{
    now += time;
    wall_clock.time.ticks += time.count() / 100;
    server.handle_deadline(now);
    run();
}

} // namespace busbar::fuzz
