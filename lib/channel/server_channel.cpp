#include <busbar/channel/server_channel.hpp>

#include <algorithm>
#include <deque>

#include <busbar/core/text.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

enum class State : std::uint8_t { Hello, Opening, Open, Closed };

/// Of the reasons why a certificate is refused a peer learns only these (Part 4, 6.1.3).
StatusCode outward(StatusCode status)
{
    const bool may_be_told = status == status::Bad_SecurityPolicyRejected ||
                             status == status::Bad_SecurityModeRejected ||
                             status == status::Bad_TcpSecureChannelUnknown ||
                             status == status::Bad_SecureChannelTokenUnknown ||
                             status == status::Bad_RequestTypeInvalid ||
                             status == status::Bad_TcpMessageTypeInvalid ||
                             status == status::Bad_TcpMessageTooLarge;
    return may_be_told ? status : status::Bad_SecurityChecksFailed;
}

} // namespace

struct ServerChannel::Impl {
    Impl(ServerChannelConfig c, const ChannelEnvironment& environment, TimePoint start)
        : config{std::move(c)}, conversation{config.limits, environment,
                                             status::Bad_ResponseTooLarge},
          now{start}, handshake_deadline{start + config.limits.handshake_timeout}
    {
    }

    [[nodiscard]] std::optional<Event> next_event();
    [[nodiscard]] Result<void> handle(const Frame& frame);
    [[nodiscard]] Result<void> handle_hello(const Frame& frame);
    [[nodiscard]] Result<void> handle_open(const Frame& frame);
    [[nodiscard]] Result<void> handle_message(const Frame& frame);
    [[nodiscard]] Result<crypto::CertificateChain> check_sender(const AsymmetricHeader& header);
    [[nodiscard]] Result<AsymmetricContent> open_request(const Frame& frame,
                                                         const AsymmetricHeader& header,
                                                         const crypto::CertificateChain& chain);
    [[nodiscard]] Result<void> check_request(const OpenSecureChannelRequest& request,
                                             const AsymmetricHeader& header,
                                             const crypto::CertificateChain& chain);
    [[nodiscard]] Result<void> issue(const OpenSecureChannelRequest& request,
                                     std::uint32_t request_id);
    void fail_with(StatusCode status, std::string_view reason);
    void end(StatusCode status, std::string reason);

    ServerChannelConfig config;
    Conversation conversation;
    State state{State::Hello};
    TimePoint now;
    TimePoint handshake_deadline;
    std::string endpoint_url;
    std::uint32_t last_token_id{0};
    ByteString client_nonce;
    std::deque<Event> events;
};

std::optional<Event> ServerChannel::Impl::next_event()
{
    while (events.empty() && state != State::Closed) {
        const auto frame = conversation.next_frame();
        if (!frame) {
            fail_with(frame.error(), "malformed message header");
            break;
        }
        if (!*frame) {
            break;
        }
        const auto handled = handle(**frame);
        if (!handled) {
            fail_with(outward(handled.error()), name(handled.error()));
        }
    }
    if (events.empty()) {
        return std::nullopt;
    }
    Event event = std::move(events.front());
    events.pop_front();
    return event;
}

/// Which message is allowed in which state; anything else is Bad_TcpMessageTypeInvalid.
Result<void> ServerChannel::Impl::handle(const Frame& frame)
{
    const MessageType type = frame.header.type;
    if (state == State::Hello && type == MessageType::HEL) {
        return handle_hello(frame);
    }
    if ((state == State::Opening || state == State::Open) && type == MessageType::OPN) {
        return handle_open(frame);
    }
    if (state == State::Open && (type == MessageType::MSG || type == MessageType::CLO)) {
        return handle_message(frame);
    }
    return fail(status::Bad_TcpMessageTypeInvalid);
}

Result<void> ServerChannel::Impl::handle_hello(const Frame& frame)
{
    const auto hello = parse_hello(frame.body());
    if (!hello) {
        fail_with(hello.error() == status::Bad_TcpEndpointUrlInvalid ? hello.error()
                                                                     : status::Bad_TcpInternalError,
                  "malformed Hello");
        return {};
    }
    if (hello->receive_buffer_size < min_buffer_size || hello->send_buffer_size < min_buffer_size) {
        fail_with(status::Bad_TcpNotEnoughResources, "the buffers must have 8192 bytes or more");
        return {};
    }
    endpoint_url = hello->endpoint_url.str();
    conversation.negotiate(*hello);
    Hello acknowledge;
    acknowledge.receive_buffer_size = conversation.sizes().receive_buffer_size;
    acknowledge.send_buffer_size = conversation.sizes().send_buffer_size;
    acknowledge.max_message_size = config.limits.max_message_size;
    acknowledge.max_chunk_count = config.limits.max_chunk_count;
    write_acknowledge(conversation.output(), acknowledge);
    state = State::Opening;
    return {};
}

Result<crypto::CertificateChain> ServerChannel::Impl::check_sender(const AsymmetricHeader& header)
{
    const ChannelEnvironment& environment = conversation.environment();
    if (header.policy->is_none()) {
        return crypto::CertificateChain{};
    }
    if (environment.identity == nullptr || environment.validator == nullptr) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    auto chain = crypto::parse_chain(header.sender_certificate);
    if (!chain) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto thumbprint = environment.identity->certificates.front().thumbprint();
    if (!std::equal(thumbprint.begin(), thumbprint.end(), header.receiver_thumbprint.begin(),
                    header.receiver_thumbprint.end())) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto valid =
        environment.validator->validate(*chain, {header.policy, environment.wall_clock->now(), {}});
    if (!valid) {
        environment.log->write(LogLevel::Warning, "channel",
                               "client certificate refused: " + std::string{name(valid.error())});
        return fail(status::Bad_SecurityChecksFailed);
    }
    return chain;
}

Result<AsymmetricContent> ServerChannel::Impl::open_request(const Frame& frame,
                                                            const AsymmetricHeader& header,
                                                            const crypto::CertificateChain& chain)
{
    const ApplicationIdentity* identity = conversation.environment().identity;
    return open_asymmetric(frame.bytes, header, identity != nullptr ? &identity->key : nullptr,
                           chain.empty() ? nullptr : &chain.front());
}

/// Part 4, 5.5.2: what a request may ask for in the state the channel is in.
Result<void> ServerChannel::Impl::check_request(const OpenSecureChannelRequest& request,
                                                const AsymmetricHeader& header,
                                                const crypto::CertificateChain& chain)
{
    const SecuritySetting wanted{header.policy, request.security_mode};
    const bool is_renewal = request.request_type == SecurityTokenRequestType::Renew;
    if (!is_renewal && request.request_type != SecurityTokenRequestType::Issue) {
        return fail(status::Bad_RequestTypeInvalid);
    }
    if (is_renewal != (state == State::Open)) {
        return fail(status::Bad_RequestTypeInvalid);
    }
    if (header.policy->is_none() != (request.security_mode == MessageSecurityMode::None)) {
        return fail(status::Bad_SecurityModeRejected);
    }
    if (std::find(config.allowed.begin(), config.allowed.end(), wanted) == config.allowed.end()) {
        return fail(status::Bad_SecurityModeRejected);
    }
    if (is_renewal &&
        (!(wanted == conversation.security) || !(chain == conversation.peer_certificates))) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (!header.policy->is_none() && (request.client_nonce.size() != header.policy->nonce_size ||
                                      request.client_nonce == client_nonce)) {
        return fail(status::Bad_SecurityChecksFailed); // Bad_NonceInvalid, for the log only
    }
    return {};
}

Result<void> ServerChannel::Impl::handle_open(const Frame& frame)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header) {
        return fail(header.error());
    }
    const bool is_known = std::any_of(config.allowed.begin(), config.allowed.end(),
                                      [&](const auto& s) { return s.policy == header->policy; });
    if (!is_known) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    if (header->channel_id != (state == State::Open ? config.channel_id : 0)) {
        return fail(state == State::Open ? status::Bad_TcpSecureChannelUnknown
                                         : status::Bad_SecurityChecksFailed);
    }
    auto chain = check_sender(*header);
    if (!chain) {
        return fail(chain.error());
    }
    const auto content = open_request(frame, *header, *chain);
    if (!content || !conversation.accept_sequence(content->sequence_number)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto request = decode_message<OpenSecureChannelRequest>(content->body);
    if (!request) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto checked = check_request(*request, *header, *chain);
    if (!checked) {
        return checked;
    }
    conversation.security = {header->policy, request->security_mode};
    conversation.peer_certificates = *std::move(chain);
    conversation.channel_id = config.channel_id;
    return issue(*request, content->request_id);
}

Result<void> ServerChannel::Impl::issue(const OpenSecureChannelRequest& request,
                                        std::uint32_t request_id)
{
    const ChannelEnvironment& environment = conversation.environment();
    std::vector<std::byte> nonce(conversation.security.policy->nonce_size);
    if (!environment.random->fill(nonce)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const auto lifetime = std::clamp(std::chrono::milliseconds{request.requested_lifetime},
                                     config.min_lifetime, config.max_lifetime);
    auto token = make_token(++last_token_id, conversation.security,
                            {nonce, request.client_nonce.span()}, lifetime, now);
    if (!token) {
        return fail(token.error());
    }
    OpenSecureChannelResponse response;
    response.response_header.timestamp = environment.wall_clock->now();
    response.response_header.request_handle = request.request_header.request_handle;
    response.security_token.channel_id = config.channel_id;
    response.security_token.token_id = last_token_id;
    response.security_token.created_at = response.response_header.timestamp;
    response.security_token.revised_lifetime = static_cast<std::uint32_t>(lifetime.count());
    response.server_nonce = ByteString{nonce};
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, response);
    const auto& peer = conversation.peer_certificates;
    const auto sent = conversation.send_open(request_id, sink.take(writer.written()),
                                             peer.empty() ? nullptr : &peer.front());
    if (!sent) {
        return sent;
    }
    client_nonce = request.client_nonce;
    conversation.offer(*std::move(token));
    const bool is_new = std::exchange(state, State::Open) == State::Opening;
    events.push_back({is_new ? Event::Kind::Opened : Event::Kind::Renewed, 0, {}, {}, {}});
    return {};
}

Result<void> ServerChannel::Impl::handle_message(const Frame& frame)
{
    const auto content = conversation.open(frame, now);
    if (!content) {
        return fail(content.error());
    }
    if (frame.header.type == MessageType::CLO) {
        end({}, {});
        return {};
    }
    auto event = conversation.assemble(frame, *content);
    if (!event) {
        return fail(event.error());
    }
    // A client that gave up a request leaves nothing to do (Part 6, 6.7.3).
    if (*event && (*event)->kind == Event::Kind::Message) {
        events.push_back(**std::move(event));
    }
    return {};
}

void ServerChannel::Impl::fail_with(StatusCode status, std::string_view reason)
{
    write_error(conversation.output(), status, name(status));
    end(status, std::string{reason});
}

void ServerChannel::Impl::end(StatusCode status, std::string reason)
{
    state = State::Closed;
    events.push_back({Event::Kind::Closed, 0, {}, status, std::move(reason)});
}

ServerChannel::ServerChannel(ServerChannelConfig config, const ChannelEnvironment& environment,
                             TimePoint now)
    : impl_{std::make_unique<Impl>(std::move(config), environment, now)}
{
}
ServerChannel::ServerChannel(ServerChannel&&) noexcept = default;
ServerChannel& ServerChannel::operator=(ServerChannel&&) noexcept = default;
ServerChannel::~ServerChannel() = default;

Result<void> ServerChannel::reverse_hello(std::string_view server_uri,
                                          std::string_view endpoint_url)
{
    if (server_uri.size() > max_url_size || endpoint_url.size() > max_url_size ||
        impl_->state != State::Hello) {
        return fail(status::Bad_InvalidArgument);
    }
    write_reverse_hello(impl_->conversation.output(), server_uri, endpoint_url);
    return {};
}

Result<void> ServerChannel::feed(std::span<const std::byte> in, TimePoint now)
{
    if (impl_->state == State::Closed) {
        return fail(status::Bad_SecureChannelClosed);
    }
    impl_->now = now;
    impl_->conversation.feed(in);
    return {};
}

std::optional<Event> ServerChannel::next_event()
{
    return impl_->next_event();
}

std::span<const std::byte> ServerChannel::output() const
{
    return impl_->conversation.output().output();
}

void ServerChannel::consume(std::size_t size)
{
    impl_->conversation.output().consume(size);
}

TimePoint ServerChannel::next_deadline() const
{
    switch (impl_->state) {
    case State::Hello:
    case State::Opening:
        return impl_->handshake_deadline;
    case State::Open:
        return impl_->conversation.expires_at();
    case State::Closed:
        break;
    }
    return no_deadline;
}

void ServerChannel::handle_deadline(TimePoint now)
{
    impl_->now = now;
    if (now >= next_deadline()) {
        impl_->fail_with(impl_->state == State::Open ? status::Bad_SecureChannelTokenUnknown
                                                     : status::Bad_Timeout,
                         "nothing came in time");
    }
}

Result<void> ServerChannel::send(std::uint32_t request_id,
                                 FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != State::Open) {
        return fail(status::Bad_SecureChannelClosed);
    }
    return impl_->conversation.send(MessageType::MSG, request_id, encode);
}

void ServerChannel::close(StatusCode status, std::string_view reason)
{
    if (impl_->state != State::Closed) {
        impl_->fail_with(status, reason);
    }
}

bool ServerChannel::is_open() const
{
    return impl_->state == State::Open;
}

bool ServerChannel::is_closed() const
{
    return impl_->state == State::Closed;
}

std::uint32_t ServerChannel::channel_id() const
{
    return impl_->config.channel_id;
}

const SecuritySetting& ServerChannel::security() const
{
    return impl_->conversation.security;
}

const crypto::CertificateChain& ServerChannel::peer_certificates() const
{
    return impl_->conversation.peer_certificates;
}

const std::string& ServerChannel::endpoint_url() const
{
    return impl_->endpoint_url;
}

} // namespace busbar::channel
