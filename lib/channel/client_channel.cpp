#include <busbar/channel/client_channel.hpp>

#include <algorithm>

#include <busbar/core/text.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"
#include "event_queue.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

enum class State : std::uint8_t { ReverseHello, Acknowledge, Opening, Open, Closed };

/// A server that grants less than this would be asked for tokens without end.
constexpr std::chrono::milliseconds min_lifetime{1'000};

} // namespace

struct ClientChannel::Impl {
    Impl(ClientChannelConfig c, const ChannelEnvironment& environment, TimePoint start)
        : config{std::move(c)}, conversation{config.limits, environment, Role::Client}, now{start},
          handshake_deadline{start + config.limits.handshake_timeout}
    {
        conversation.security = config.security;
    }

    void say_hello();
    [[nodiscard]] std::optional<Event> next_event();
    [[nodiscard]] Result<void> handle(const Frame& frame);
    [[nodiscard]] Result<void> handle_reverse_hello(const Frame& frame);
    [[nodiscard]] Result<void> handle_error(const Frame& frame);
    [[nodiscard]] Result<void> handle_acknowledge(const Frame& frame);
    [[nodiscard]] Result<void> handle_open(const Frame& frame);
    [[nodiscard]] Result<void> handle_message(const Frame& frame);
    [[nodiscard]] Result<void> request_token(SecurityTokenRequestType type);
    [[nodiscard]] Result<AsymmetricContent> open_response(const Frame& frame);
    [[nodiscard]] Result<void> check_server(const AsymmetricHeader& header);
    [[nodiscard]] Result<void> take_token(const OpenSecureChannelResponse& response);
    [[nodiscard]] std::uint32_t next_request_id();
    void send_close();
    void refuse(StatusCode status, std::string_view reason);
    void end(StatusCode status, std::string reason);

    ClientChannelConfig config;
    Conversation conversation;
    State state{State::Acknowledge};
    TimePoint now;
    TimePoint handshake_deadline;
    std::uint32_t last_request_id{0};
    std::uint32_t open_request_id{0}; // 0 while no OPN is on its way
    crypto::Secret nonce;
    ByteString server_nonce;
    EventQueue events;
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
            refuse(frame.error(), "malformed message header");
        } else if (!*frame) {
            break;
        } else if (const auto handled = handle(**frame); !handled) {
            refuse(handled.error(), "the server's message was refused");
        }
    }
    return events.pop();
}

Result<void> ClientChannel::Impl::handle(const Frame& frame)
{
    const MessageType type = frame.header.type;
    if (type == MessageType::ERR) {
        return handle_error(frame);
    }
    if (state == State::ReverseHello && type == MessageType::RHE) {
        return handle_reverse_hello(frame);
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

Result<void> ClientChannel::Impl::handle_reverse_hello(const Frame& frame)
{
    const auto message = parse_reverse_hello(frame.body());
    if (!message) {
        return fail(message.error());
    }
    if (!config.expected_server_uri.empty() &&
        message->server_uri.view() != config.expected_server_uri) {
        return fail(status::Bad_TcpEndpointUrlInvalid); // Part 6, 7.1.2.6
    }
    config.endpoint_url = message->endpoint_url.str();
    say_hello();
    return {};
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

std::uint32_t ClientChannel::Impl::next_request_id()
{
    last_request_id = std::max<std::uint32_t>(last_request_id + 1, 1); // 0 is none
    return last_request_id;
}

Result<void> ClientChannel::Impl::request_token(SecurityTokenRequestType type)
{
    const ChannelEnvironment& environment = conversation.environment();
    nonce = crypto::Secret{config.security.policy->nonce_size};
    if (!environment.random->fill(nonce.span())) {
        return fail(status::Bad_ResourceUnavailable);
    }
    OpenSecureChannelRequest request;
    request.request_header.timestamp = environment.wall_clock->now();
    request.request_type = type;
    request.security_mode = config.security.mode;
    request.client_nonce = ByteString{nonce.span()};
    request.requested_lifetime = static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(config.requested_lifetime.count(), 0, UINT32_MAX));
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, request);
    auto body = sink.take(writer.written());
    open_request_id = next_request_id();
    const auto sent = conversation.send_open(
        open_request_id, body, config.server_certificate ? &*config.server_certificate : nullptr);
    crypto::cleanse(body);
    return sent;
}

/// The server must be the one whose certificate the endpoint showed, and trusted (Part 4, 6.1.3).
Result<void> ClientChannel::Impl::check_server(const AsymmetricHeader& header)
{
    const ChannelEnvironment& environment = conversation.environment();
    const auto thumbprint = environment.identity->certificates.front().thumbprint();
    if (!std::ranges::equal(thumbprint, header.receiver_thumbprint)) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto chain = crypto::parse_chain(header.sender_certificate);
    if (!chain || !(chain->front() == *config.server_certificate)) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto valid =
        environment.validator->validate(*chain, {header.policy, environment.wall_clock->now(), {}});
    if (valid) {
        conversation.peer_certificates = *chain;
    }
    return valid;
}

Result<AsymmetricContent> ClientChannel::Impl::open_response(const Frame& frame)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header || header->policy != config.security.policy) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (header->policy->is_none()) {
        return open_asymmetric(frame.bytes, *header, nullptr, nullptr);
    }
    const auto checked = check_server(*header);
    if (!checked) {
        return fail(checked.error());
    }
    return open_asymmetric(frame.bytes, *header, &conversation.environment().identity->key,
                           &*config.server_certificate);
}

Result<void> ClientChannel::Impl::handle_open(const Frame& frame)
{
    const auto content = open_response(frame);
    if (!content) {
        return fail(content.error());
    }
    if (!conversation.accept_sequence(content->sequence_number)) {
        return fail(status::Bad_SequenceNumberInvalid);
    }
    if (open_request_id == 0 || content->request_id != open_request_id) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (const auto fault = decode_message<ServiceFault>(content->body)) {
        const StatusCode result = fault->response_header.service_result;
        return fail(result.is_bad() ? result : status::Bad_UnknownResponse);
    }
    const auto response = decode_message<OpenSecureChannelResponse>(content->body);
    if (!response) {
        return fail(response.error());
    }
    if (response->response_header.service_result.is_bad()) {
        return fail(response->response_header.service_result);
    }
    const auto taken = take_token(*response);
    if (!taken) {
        return taken;
    }
    open_request_id = 0;
    const bool is_new = std::exchange(state, State::Open) == State::Opening;
    events.push({is_new ? Event::Kind::Opened : Event::Kind::Renewed, 0, {}, {}, {}});
    return {};
}

Result<void> ClientChannel::Impl::take_token(const OpenSecureChannelResponse& response)
{
    const auto& issued = response.security_token;
    if (issued.channel_id == 0 ||
        (state == State::Open && issued.channel_id != conversation.channel_id)) {
        return fail(status::Bad_TcpSecureChannelUnknown);
    }
    // Part 6, 6.7.4: of the policy's length, and neither ours nor the one before come back.
    if (!config.security.policy->is_none() &&
        (response.server_nonce.size() != nonce.size() || response.server_nonce == server_nonce ||
         std::ranges::equal(response.server_nonce.span(), nonce.span()))) {
        return fail(status::Bad_NonceInvalid);
    }
    const auto lifetime =
        std::max(std::chrono::milliseconds{issued.revised_lifetime}, min_lifetime);
    auto token = make_token(issued.token_id, config.security,
                            {nonce.span(), response.server_nonce.span()}, lifetime, now);
    if (!token) {
        return fail(token.error());
    }
    conversation.channel_id = issued.channel_id;
    conversation.use(*std::move(token));
    server_nonce = response.server_nonce;
    return {};
}

Result<void> ClientChannel::Impl::handle_message(const Frame& frame)
{
    const auto content = conversation.open(frame, now);
    if (!content) {
        return fail(content.error());
    }
    auto event = conversation.assembly().add(frame.header.chunk, *content);
    if (!event) {
        return fail(event.error());
    }
    if (*event) {
        events.push(**std::move(event));
    }
    return {};
}

void ClientChannel::Impl::send_close()
{
    CloseSecureChannelRequest request;
    request.request_header.timestamp = conversation.environment().wall_clock->now();
    static_cast<void>(
        conversation.send(MessageType::CLO, next_request_id(),
                          [&](binary::Writer& writer) { encode_message(writer, request); }));
}

/// Where an error of the server ends the connection (Part 6, 7.1.5).
void ClientChannel::Impl::refuse(StatusCode status, std::string_view reason)
{
    if (state == State::Open) {
        send_close();
    } else if (state == State::ReverseHello) {
        write_error(conversation.output(), status, name(status)); // Part 6, 7.1.2.6
    }
    end(status, std::string{reason});
}

void ClientChannel::Impl::end(StatusCode status, std::string reason)
{
    state = State::Closed;
    events.push({Event::Kind::Closed, 0, {}, status, std::move(reason)});
}

ClientChannel::ClientChannel(ClientChannelConfig config, const ChannelEnvironment& environment,
                             TimePoint now)
    : impl_{std::make_unique<Impl>(std::move(config), environment, now)}
{
    const SecuritySetting& security = impl_->config.security;
    const bool is_complete = environment.identity != nullptr && environment.validator != nullptr &&
                             impl_->config.server_certificate;
    if (!security.policy->is_none() && !is_complete) {
        impl_->end(status::Bad_ConfigurationError,
                   "the policy needs both certificates and a validator");
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
            impl_->refuse(sent.error(), "the SecurityToken could not be renewed");
        }
        return;
    }
    impl_->refuse(status::Bad_Timeout, "the server did not answer in time");
}

Result<std::uint32_t> ClientChannel::send(FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != State::Open) {
        return fail(status::Bad_SecureChannelClosed);
    }
    const std::uint32_t before = impl_->last_request_id;
    const std::uint32_t id = impl_->next_request_id();
    const auto sent = impl_->conversation.send(MessageType::MSG, id, encode);
    if (!sent) {
        impl_->last_request_id = before;
        return fail(sent.error());
    }
    return id;
}

void ClientChannel::close()
{
    if (impl_->state == State::Open) {
        impl_->send_close();
    }
    if (impl_->state != State::Closed) {
        impl_->end({}, {});
    }
}

void ClientChannel::recycle(std::vector<std::byte> body)
{
    impl_->conversation.assembly().recycle(std::move(body));
}

std::size_t ClientChannel::memory_in_use() const
{
    return impl_->conversation.memory_in_use();
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

const std::string& ClientChannel::endpoint_url() const
{
    return impl_->config.endpoint_url;
}

} // namespace busbar::channel
