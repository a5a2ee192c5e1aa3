#include <busbar/channel/client_channel.hpp>

#include <deque>

#include <busbar/core/text.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

enum class State : std::uint8_t { ReverseHello, Acknowledge, Opening, Open, Closed };

} // namespace

struct ClientChannel::Impl {
    Impl(ClientChannelConfig c, const ChannelEnvironment& environment, TimePoint start)
        : config{std::move(c)}, conversation{config.limits, environment,
                                             status::Bad_RequestTooLarge},
          now{start}, handshake_deadline{start + config.limits.handshake_timeout}
    {
        conversation.security = config.security;
    }

    void say_hello();
    [[nodiscard]] std::optional<Event> next_event();
    [[nodiscard]] Result<void> handle(const Frame& frame);
    [[nodiscard]] Result<void> handle_error(const Frame& frame);
    [[nodiscard]] Result<void> handle_acknowledge(const Frame& frame);
    [[nodiscard]] Result<void> handle_open(const Frame& frame);
    [[nodiscard]] Result<void> handle_message(const Frame& frame);
    [[nodiscard]] Result<void> request_token(SecurityTokenRequestType type);
    [[nodiscard]] Result<AsymmetricContent> open_response(const Frame& frame);
    void end(StatusCode status, std::string reason);

    ClientChannelConfig config;
    Conversation conversation;
    State state{State::Acknowledge};
    TimePoint now;
    TimePoint handshake_deadline;
    std::uint32_t last_request_id{0};
    std::uint32_t open_request_id{0}; // 0 while no OPN is on its way
    std::vector<std::byte> nonce;
    std::deque<Event> events;
};

void ClientChannel::Impl::say_hello()
{
    Hello hello = conversation.sizes();
    hello.endpoint_url = String{config.endpoint_url};
    write_hello(conversation.output(), hello);
    state = State::Acknowledge;
}

std::optional<Event> ClientChannel::Impl::next_event()
{
    while (events.empty() && state != State::Closed) {
        const auto frame = conversation.next_frame();
        if (!frame) {
            end(frame.error(), "malformed message header");
            break;
        }
        if (!*frame) {
            break;
        }
        const auto handled = handle(**frame);
        if (!handled) {
            end(handled.error(), "the server's message was refused");
        }
    }
    if (events.empty()) {
        return std::nullopt;
    }
    Event event = std::move(events.front());
    events.pop_front();
    return event;
}

Result<void> ClientChannel::Impl::handle(const Frame& frame)
{
    const MessageType type = frame.header.type;
    if (type == MessageType::ERR) {
        return handle_error(frame);
    }
    if (state == State::ReverseHello && type == MessageType::RHE) {
        const auto message = parse_reverse_hello(frame.body());
        if (!message) {
            return fail(message.error());
        }
        config.endpoint_url = message->endpoint_url.str();
        say_hello();
        return {};
    }
    if (state == State::Acknowledge && type == MessageType::ACK) {
        return handle_acknowledge(frame);
    }
    if ((state == State::Opening || state == State::Open) && type == MessageType::OPN) {
        return handle_open(frame);
    }
    if (state == State::Open && type == MessageType::MSG) {
        return handle_message(frame);
    }
    return fail(status::Bad_TcpMessageTypeInvalid);
}

Result<void> ClientChannel::Impl::handle_error(const Frame& frame)
{
    const auto message = parse_error(frame.body());
    const StatusCode status = message ? message->error : status::Bad_DecodingError;
    end(status.is_bad() ? status : status::Bad_ConnectionClosed,
        message ? printable(message->reason.view()) : std::string{});
    return {};
}

Result<void> ClientChannel::Impl::handle_acknowledge(const Frame& frame)
{
    const auto acknowledge = parse_acknowledge(frame.body());
    if (!acknowledge || acknowledge->receive_buffer_size < min_buffer_size ||
        acknowledge->send_buffer_size < min_buffer_size) {
        return fail(status::Bad_TcpInternalError);
    }
    conversation.negotiate(*acknowledge);
    state = State::Opening;
    return request_token(SecurityTokenRequestType::Issue);
}

Result<void> ClientChannel::Impl::request_token(SecurityTokenRequestType type)
{
    const ChannelEnvironment& environment = conversation.environment();
    nonce.resize(config.security.policy->nonce_size);
    if (!environment.random->fill(nonce)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    OpenSecureChannelRequest request;
    request.request_header.timestamp = environment.wall_clock->now();
    request.request_type = type;
    request.security_mode = config.security.mode;
    request.client_nonce = ByteString{nonce};
    request.requested_lifetime = static_cast<std::uint32_t>(config.requested_lifetime.count());
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, request);
    open_request_id = ++last_request_id;
    return conversation.send_open(open_request_id, sink.take(writer.written()),
                                  config.server_certificate ? &*config.server_certificate
                                                            : nullptr);
}

Result<AsymmetricContent> ClientChannel::Impl::open_response(const Frame& frame)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header || header->policy != config.security.policy) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const ChannelEnvironment& environment = conversation.environment();
    if (header->policy->is_none()) {
        return open_asymmetric(frame.bytes, *header, nullptr, nullptr);
    }
    // The server must be the one whose certificate the endpoint showed (Part 4, 6.1.4).
    const auto chain = crypto::parse_chain(header->sender_certificate);
    if (!chain || !(chain->front() == *config.server_certificate)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return open_asymmetric(frame.bytes, *header, &environment.identity->key, &chain->front());
}

Result<void> ClientChannel::Impl::handle_open(const Frame& frame)
{
    const auto content = open_response(frame);
    if (!content || !conversation.accept_sequence(content->sequence_number) ||
        open_request_id == 0 || content->request_id != open_request_id) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto response = decode_message<OpenSecureChannelResponse>(content->body);
    if (!response) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (response->response_header.service_result.is_bad()) {
        return fail(response->response_header.service_result);
    }
    const bool is_new = state == State::Opening;
    const auto& issued = response->security_token;
    if (response->server_nonce.size() != config.security.policy->nonce_size ||
        (!is_new && issued.channel_id != conversation.channel_id)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    conversation.channel_id = issued.channel_id;
    auto token =
        make_token(issued.token_id, config.security, {nonce, response->server_nonce.span()},
                   std::chrono::milliseconds{issued.revised_lifetime}, now);
    if (!token) {
        return fail(token.error());
    }
    conversation.use(*std::move(token));
    open_request_id = 0;
    state = State::Open;
    events.push_back({is_new ? Event::Kind::Opened : Event::Kind::Renewed, 0, {}, {}, {}});
    return {};
}

Result<void> ClientChannel::Impl::handle_message(const Frame& frame)
{
    const auto content = conversation.open(frame, now);
    if (!content) {
        return fail(content.error());
    }
    auto event = conversation.assemble(frame, *content);
    if (!event) {
        return fail(event.error());
    }
    if (*event) {
        events.push_back(**std::move(event));
    }
    return {};
}

void ClientChannel::Impl::end(StatusCode status, std::string reason)
{
    state = State::Closed;
    events.push_back({Event::Kind::Closed, 0, {}, status, std::move(reason)});
}

ClientChannel::ClientChannel(ClientChannelConfig config, const ChannelEnvironment& environment,
                             TimePoint now)
    : impl_{std::make_unique<Impl>(std::move(config), environment, now)}
{
    const SecuritySetting& security = impl_->config.security;
    if (!security.policy->is_none() &&
        (environment.identity == nullptr || !impl_->config.server_certificate)) {
        impl_->end(status::Bad_ConfigurationError, "the policy needs both certificates");
    } else if (impl_->config.is_reverse) {
        impl_->state = State::ReverseHello;
    } else {
        impl_->say_hello();
    }
}
ClientChannel::ClientChannel(ClientChannel&&) noexcept = default;
ClientChannel& ClientChannel::operator=(ClientChannel&&) noexcept = default;
ClientChannel::~ClientChannel() = default;

Result<void> ClientChannel::feed(std::span<const std::byte> in, TimePoint now)
{
    if (impl_->state == State::Closed) {
        return fail(status::Bad_SecureChannelClosed);
    }
    impl_->now = now;
    impl_->conversation.feed(in);
    return {};
}

std::optional<Event> ClientChannel::next_event()
{
    return impl_->next_event();
}

std::span<const std::byte> ClientChannel::output() const
{
    return impl_->conversation.output().output();
}

void ClientChannel::consume(std::size_t size)
{
    impl_->conversation.output().consume(size);
}

TimePoint ClientChannel::next_deadline() const
{
    if (impl_->state == State::Closed) {
        return no_deadline;
    }
    if (impl_->state != State::Open) {
        return impl_->handshake_deadline;
    }
    return impl_->open_request_id != 0 ? impl_->conversation.expires_at()
                                       : impl_->conversation.renew_at();
}

void ClientChannel::handle_deadline(TimePoint now)
{
    impl_->now = now;
    if (now < next_deadline()) {
        return;
    }
    if (impl_->state == State::Open && impl_->open_request_id == 0) {
        const auto sent = impl_->request_token(SecurityTokenRequestType::Renew);
        if (!sent) {
            impl_->end(sent.error(), "the SecurityToken could not be renewed");
        }
        return;
    }
    impl_->end(status::Bad_Timeout, "the server did not answer in time");
}

Result<std::uint32_t> ClientChannel::send(FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != State::Open) {
        return fail(status::Bad_SecureChannelClosed);
    }
    const std::uint32_t id = impl_->last_request_id + 1 == 0 ? 1 : impl_->last_request_id + 1;
    const auto sent = impl_->conversation.send(MessageType::MSG, id, encode);
    if (!sent) {
        return fail(sent.error());
    }
    impl_->last_request_id = id;
    return id;
}

void ClientChannel::close()
{
    if (impl_->state == State::Open) {
        CloseSecureChannelRequest request;
        request.request_header.timestamp = impl_->conversation.environment().wall_clock->now();
        static_cast<void>(impl_->conversation.send(
            MessageType::CLO, ++impl_->last_request_id,
            [&](binary::Writer& writer) { encode_message(writer, request); }));
    }
    if (impl_->state != State::Closed) {
        impl_->end({}, {});
    }
}

bool ClientChannel::is_open() const
{
    return impl_->state == State::Open;
}

bool ClientChannel::is_closed() const
{
    return impl_->state == State::Closed;
}

std::uint32_t ClientChannel::channel_id() const
{
    return impl_->conversation.channel_id;
}

const SecuritySetting& ClientChannel::security() const
{
    return impl_->conversation.security;
}

} // namespace busbar::channel
