#include <busbar/channel/client_channel.hpp>

#include <algorithm>

#include <busbar/core/text.hpp>

#include "channel_input.hpp"
#include "client_impl.hpp"
#include "refusals.hpp"

namespace busbar::channel {

using namespace detail;

void ClientChannel::Impl::say_hello()
{
    Hello hello = conversation.sizes();
    hello.endpoint_url = String{config.endpoint_url};
    write_hello(conversation.output(), hello);
    state = ClientChannelState::Acknowledge;
}

Checked<void> ClientChannel::Impl::handle(const Frame& frame)
{
    const MessageType type = frame.header.type;
    if (type == MessageType::ERR) {
        handle_error(frame);
        return {};
    }
    if (state == ClientChannelState::ReverseHello && type == MessageType::RHE) {
        return handle_reverse_hello(frame);
    }
    if (state == ClientChannelState::Acknowledge && type == MessageType::ACK) {
        return handle_acknowledge(frame);
    }
    if ((state == ClientChannelState::Opening || state == ClientChannelState::Open) &&
        type == MessageType::OPN) {
        return handle_open(frame);
    }
    if (state == ClientChannelState::Open && type == MessageType::MSG) {
        return handle_message(frame);
    }
    return refuse(protocol_refusal(status::Bad_TcpMessageTypeInvalid));
}

Checked<void> ClientChannel::Impl::handle_reverse_hello(const Frame& frame)
{
    const auto message = parse_reverse_hello(frame.body());
    if (!message) {
        return refuse(protocol_refusal(message.error()));
    }
    if (!config.expected_server_uri.empty() &&
        message->server_uri.view() != config.expected_server_uri) {
        return refuse({status::Bad_TcpEndpointUrlInvalid, "ReverseHello",
                       "it comes from " + printable(message->server_uri.view()) + ", not from " +
                           config.expected_server_uri,
                       "Part 6, 7.1.2.6", "Correct the ServerUri that is expected"});
    }
    config.endpoint_url = message->endpoint_url.str();
    say_hello();
    return {};
}

void ClientChannel::Impl::handle_error(const Frame& frame)
{
    const auto message = parse_error(frame.body());
    const StatusCode status = message ? message->error : status::Bad_DecodingError;
    end(status.is_bad() ? status : status::Bad_ConnectionClosed,
        message ? printable(message->reason.view()) : std::string{});
}

Checked<void> ClientChannel::Impl::handle_acknowledge(const Frame& frame)
{
    const auto acknowledge = parse_acknowledge(frame.body());
    if (!acknowledge || acknowledge->receive_buffer_size < min_buffer_size ||
        acknowledge->send_buffer_size < min_buffer_size) {
        return refuse({status::Bad_TcpInternalError, "Acknowledge",
                       "one that cannot be read, or buffers of less than 8,192 bytes",
                       "Part 6, 7.1.2.4", "The server's OPC UA stack is at fault"});
    }
    conversation.negotiate(*acknowledge);
    state = ClientChannelState::Opening;
    if (const auto sent = request_token(SecurityTokenRequestType::Issue); !sent) {
        return refuse({sent.error(), "OpenSecureChannel request", "it could not be secured",
                       "Part 6, 6.7.4", "Check this application's certificate and key"});
    }
    return {};
}

std::uint32_t ClientChannel::Impl::next_request_id()
{
    last_request_id = std::max<std::uint32_t>(last_request_id + 1, 1); // 0 means none
    return last_request_id;
}

Checked<void> ClientChannel::Impl::handle_message(const Frame& frame)
{
    const auto content = conversation.open(frame, now);
    if (!content) {
        return refuse(protocol_refusal(content.error()));
    }
    auto event = add_chunk(conversation, frame, *content);
    if (!event) {
        return refuse(std::move(event).error());
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

/// Ends the connection after an error of the server (Part 6, 7.1.5).
void ClientChannel::Impl::give_up(const Refusal& refusal)
{
    const StatusCode status = refusal.status;
    explain(*conversation.environment().log, "channel", refusal);
    if (state == ClientChannelState::Open) {
        send_close();
    } else if (state == ClientChannelState::ReverseHello) {
        write_error(conversation.output(), status, name(status)); // Part 6, 7.1.2.6
    }
    end(status, text(refusal));
}

void ClientChannel::Impl::end(StatusCode status, std::string reason)
{
    state = ClientChannelState::Closed;
    events.push_closed(status, std::move(reason));
}

ClientChannel::ClientChannel(ClientChannelConfig config, const ChannelEnvironment& environment,
                             TimePoint now)
    : impl_{std::make_unique<Impl>(std::move(config), environment, now)}
{
    const SecuritySetting& security = impl_->config.security;
    const bool is_complete = environment.identity != nullptr && environment.validator != nullptr &&
                             impl_->config.server_certificate;
    if (security.policy->is_deprecated) {
        environment.log->write(LogLevel::Warning, "channel",
                               "INSECURE: connecting with " + std::string{security.policy->name} +
                                   ", which relies on SHA-1 and is deprecated (Part 7, 6.6)");
    }
    if (!security.policy->is_none() && !is_complete) {
        impl_->end(status::Bad_ConfigurationError,
                   "the policy needs both certificates and a validator");
    } else if (impl_->config.is_reverse) {
        impl_->state = ClientChannelState::ReverseHello;
    } else {
        impl_->say_hello();
    }
}
ClientChannel::ClientChannel(ClientChannel&&) noexcept = default;
ClientChannel& ClientChannel::operator=(ClientChannel&&) noexcept = default;
ClientChannel::~ClientChannel() = default;

Result<void> ClientChannel::feed(std::span<const std::byte> in, TimePoint now)
{
    if (impl_->state == ClientChannelState::Closed) {
        return fail(status::Bad_SecureChannelClosed);
    }
    impl_->now = now;
    impl_->conversation.feed(in);
    return {};
}

std::optional<ChannelEvent> ClientChannel::next_event()
{
    return next_event_of(*impl_);
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
    if (impl_->state == ClientChannelState::Closed) {
        return no_deadline;
    }
    if (impl_->state != ClientChannelState::Open) {
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
    if (impl_->state == ClientChannelState::Open && impl_->open_request_id == 0) {
        const auto sent = impl_->request_token(SecurityTokenRequestType::Renew);
        if (!sent) {
            impl_->give_up({sent.error(),
                            "renewal",
                            "the SecurityToken could not be renewed",
                            "Part 4, 5.6.2.1",
                            {}});
        }
        return;
    }
    impl_->give_up({status::Bad_Timeout,
                    "handshake",
                    "the server did not answer in time",
                    "Part 6, 7.1.3",
                    {}});
}

Result<std::uint32_t> ClientChannel::send(FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != ClientChannelState::Open) {
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
    if (impl_->state == ClientChannelState::Open) {
        impl_->send_close();
    }
    if (impl_->state != ClientChannelState::Closed) {
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
    return impl_->state == ClientChannelState::Open;
}

bool ClientChannel::is_closed() const
{
    return impl_->state == ClientChannelState::Closed;
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
