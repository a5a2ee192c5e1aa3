#include <busbar/channel/server_channel.hpp>

#include <algorithm>
#include <array>

#include <busbar/channel/open_gate.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

#include "channel_input.hpp"
#include "channel_record.hpp"
#include "refusals.hpp"
#include "server_impl.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

/// The statuses that a peer may see; for all others it gets Bad_SecurityChecksFailed (Part 4, 6.1.3
/// and Part 6, 6.7.7).
constexpr std::array told = {
    status::Bad_TcpMessageTypeInvalid,   status::Bad_TcpMessageTooLarge,
    status::Bad_TcpNotEnoughResources,   status::Bad_TcpServerTooBusy,
    status::Bad_TcpInternalError,        status::Bad_TcpEndpointUrlInvalid,
    status::Bad_TcpSecureChannelUnknown, status::Bad_SecureChannelTokenUnknown,
    status::Bad_SecurityPolicyRejected,  status::Bad_SecurityModeRejected,
    status::Bad_RequestTypeInvalid,      status::Bad_Timeout,
};

StatusCode outward(StatusCode status)
{
    const bool is_told = std::find(told.begin(), told.end(), status) != told.end();
    return is_told ? status : status::Bad_SecurityChecksFailed;
}

} // namespace

/// Decides which message is allowed in which state; others are Bad_TcpMessageTypeInvalid.
Checked<void> ServerChannel::Impl::handle(const Frame& frame)
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
    if (is_reverse && state == State::Hello && type == MessageType::ERR) {
        const auto error = parse_error(frame.body()); // the client does not want the connection
        end(error ? error->error : status::Bad_DecodingError, "the client refused");
        return {};
    }
    return refuse(protocol_refusal(status::Bad_TcpMessageTypeInvalid));
}

Checked<void> ServerChannel::Impl::handle_hello(const Frame& frame)
{
    const auto hello = parse_hello(frame.body());
    if (!hello) {
        const bool is_url = hello.error() == status::Bad_TcpEndpointUrlInvalid;
        return refuse(protocol_refusal(is_url ? hello.error() : status::Bad_TcpInternalError));
    }
    if (hello->receive_buffer_size < min_buffer_size || hello->send_buffer_size < min_buffer_size) {
        return refuse(protocol_refusal(status::Bad_TcpNotEnoughResources)); // Part 6, 7.1.2.3
    }
    endpoint_url = hello->endpoint_url.str();
    conversation.negotiate(*hello);
    Hello acknowledge;
    acknowledge.receive_buffer_size = conversation.sizes().receive_buffer_size;
    acknowledge.send_buffer_size = conversation.sizes().send_buffer_size;
    acknowledge.max_message_size = conversation.limits().max_message_size;
    acknowledge.max_chunk_count = conversation.limits().max_chunk_count;
    write_acknowledge(conversation.output(), acknowledge);
    state = State::Opening;
    return {};
}

Checked<void> ServerChannel::Impl::handle_message(const Frame& frame)
{
    const auto content = conversation.open(frame, now);
    if (!content) {
        return refuse(protocol_refusal(content.error()));
    }
    prove();
    if (frame.header.type == MessageType::CLO) {
        record_closed(conversation, config.channel_id, content->body);
        end({}, {});
        return {};
    }
    if (frame.header.chunk == 'A' && !conversation.assembly().has_begun()) {
        return refuse(protocol_refusal(status::Bad_TcpMessageTypeInvalid));
    }
    auto event = add_chunk(conversation, frame, *content);
    if (!event) {
        return refuse(std::move(event).error());
    }
    // An aborted request of a client needs no action (Part 6, 6.7.3).
    if (*event && (*event)->kind == ChannelEvent::Kind::Message) {
        events.push(**std::move(event));
    }
    return {};
}

/// Turns an error of the peer into an Error message (Part 6, 7.1.5).
void ServerChannel::Impl::give_up(const Refusal& refusal)
{
    if (!is_refusal_known) {
        Record record{RecordKind::ChannelRefused, LogLevel::Warning, "channel"};
        record.status = refusal.status;
        record.refusal = &refusal;
        record.actor.secure_channel_id = config.channel_id;
        tell(*conversation.environment().log, record);
    }
    fail_with(outward(refusal.status), refusal.status, name(refusal.status));
}

void ServerChannel::Impl::fail_with(StatusCode told_status, StatusCode status,
                                    std::string_view reason)
{
    state = State::Closed; // whether or not there is memory for what follows
    drop_work();
    write_error(conversation.output(), told_status, name(told_status));
    end(status, std::string{reason});
}

void ServerChannel::Impl::end(StatusCode status, std::string reason)
{
    state = State::Closed;
    turn = no_deadline;
    conversation.is_held = false;
    report_failure();
    drop_work();
    conversation.assembly().end();
    events.push_closed(status, std::move(reason));
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
        impl_->state != Impl::State::Hello) {
        return fail(status::Bad_InvalidArgument);
    }
    impl_->is_reverse = true;
    impl_->handshake_deadline = no_deadline; // the client decides when it begins
    write_reverse_hello(impl_->conversation.output(), server_uri, endpoint_url);
    return {};
}

Result<void> ServerChannel::feed(std::span<const std::byte> in, TimePoint now)
{
    if (impl_->state == Impl::State::Closed) {
        return fail(status::Bad_SecureChannelClosed);
    }
    impl_->advance(now);
    if (impl_->handshake_deadline == no_deadline && !in.empty()) {
        impl_->handshake_deadline = now + impl_->config.limits.handshake_timeout;
    }
    impl_->conversation.feed(in);
    return {};
}

std::optional<ChannelEvent> ServerChannel::next_event()
{
    return next_event_of(*impl_);
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
    case Impl::State::Hello:
    case Impl::State::Opening:
        return std::min(impl_->handshake_deadline, impl_->turn);
    case Impl::State::Open:
        return std::min(impl_->conversation.expires_at(), impl_->turn);
    case Impl::State::Closed:
        break;
    }
    return no_deadline;
}

void ServerChannel::handle_deadline(TimePoint now)
{
    impl_->advance(now);
    if (impl_->state == Impl::State::Hello || impl_->state == Impl::State::Opening) {
        if (now >= impl_->handshake_deadline) {
            // Our own delay is not the peer's failure.
            impl_->is_at_work = impl_->is_at_work && !impl_->progress.is_under_way();
            impl_->give_up(protocol_refusal(status::Bad_Timeout)); // Part 6, 7.1.3
        }
    } else if (impl_->state == Impl::State::Open && impl_->conversation.expire(now)) {
        impl_->give_up(protocol_refusal(status::Bad_SecureChannelTokenUnknown));
    }
}

Result<void> ServerChannel::send(std::uint32_t request_id,
                                 FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != Impl::State::Open) {
        return fail(status::Bad_SecureChannelClosed);
    }
    return impl_->conversation.send(MessageType::MSG, request_id, encode);
}

void ServerChannel::close(StatusCode status, std::string_view reason)
{
    if (impl_->state != Impl::State::Closed) {
        impl_->fail_with(status, status, reason);
    }
}

void ServerChannel::limit_messages(std::uint32_t size)
{
    impl_->conversation.assembly().limit_messages(size);
}

void ServerChannel::reserve_response()
{
    detail::Conversation& conversation = impl_->conversation;
    static_cast<void>(conversation.output().reserve(conversation.sizes().send_buffer_size));
}

void ServerChannel::recycle(std::vector<std::byte> body)
{
    impl_->conversation.assembly().recycle(std::move(body));
}

std::size_t ServerChannel::max_response_size() const
{
    // Upper bound of headers, signature and padding of a chunk.
    constexpr std::size_t overhead = 256;
    const auto& sizes = impl_->conversation.sizes();
    const std::size_t in_chunks =
        std::size_t{sizes.max_chunk_count} * (sizes.send_buffer_size - overhead);
    return std::min<std::size_t>(sizes.max_message_size, in_chunks);
}

std::size_t ServerChannel::unsent_size() const
{
    return impl_->conversation.output().size();
}

std::size_t ServerChannel::unfinished_size() const
{
    return impl_->conversation.assembly().unfinished_size();
}

std::size_t ServerChannel::memory_in_use() const
{
    return impl_->conversation.memory_in_use();
}

bool ServerChannel::is_waiting() const
{
    return impl_->conversation.is_held;
}

void ServerChannel::work_done(StatusCode status, TimePoint now)
{
    impl_->advance(now);
    impl_->work_done(status);
}

bool ServerChannel::is_open() const
{
    return impl_->state == Impl::State::Open;
}

bool ServerChannel::is_closed() const
{
    return impl_->state == Impl::State::Closed;
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
