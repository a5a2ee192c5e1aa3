#include "conversation.hpp"

#include <algorithm>

namespace busbar::channel::detail {

namespace {

/// 0 is the peer's word for "no limit"; ours always is one (Part 6, 7.1.2.3).
std::uint32_t stricter(std::uint32_t peer, std::uint32_t own)
{
    return peer == 0 ? own : std::min(peer, own);
}

ErrorMessage parse_abort(std::span<const std::byte> body)
{
    auto message = parse_error(body);
    return message ? *std::move(message) : ErrorMessage{status::Bad_DecodingError, {}};
}

} // namespace

Conversation::Conversation(const TransportLimits& limits, const ChannelEnvironment& environment,
                           StatusCode too_large)
    : limits_{limits}, environment_{environment}, too_large_{too_large}
{
    sizes_.receive_buffer_size = std::max(limits.receive_buffer_size, min_buffer_size);
    sizes_.send_buffer_size = std::max(limits.send_buffer_size, min_buffer_size);
    sizes_.max_message_size = limits.max_message_size;
    sizes_.max_chunk_count = limits.max_chunk_count;
}

void Conversation::feed(std::span<const std::byte> in)
{
    if (input_begin_ == input_.size()) {
        input_.clear();
        input_begin_ = 0;
    } else if (input_begin_ > input_.size() / 2) {
        input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(input_begin_));
        input_begin_ = 0;
    }
    input_.insert(input_.end(), in.begin(), in.end());
}

Result<std::optional<Frame>> Conversation::next_frame()
{
    const auto waiting = std::span{input_}.subspan(input_begin_);
    if (waiting.size() < header_size) {
        return std::nullopt;
    }
    const auto header = parse_frame_header(waiting, max_frame_size);
    if (!header) {
        return fail(header.error());
    }
    if (waiting.size() < header->size) {
        return std::nullopt;
    }
    input_begin_ += header->size;
    return Frame{*header, waiting.first(header->size)};
}

Token* Conversation::find_token(std::uint32_t id, TimePoint now)
{
    if (offered_ && offered_->id == id) {
        // Part 4, 5.5.2.1: the first message under the new token ends the old one.
        current_ = std::exchange(offered_, std::nullopt);
        previous_.reset();
    }
    if (current_ && current_->id == id) {
        return now < current_->expires_at ? &*current_ : nullptr;
    }
    return previous_ && previous_->id == id && now < previous_->expires_at ? &*previous_ : nullptr;
}

Result<SymmetricContent> Conversation::open(const Frame& frame, TimePoint now)
{
    const auto header = parse_symmetric_header(frame.bytes);
    if (!header) {
        return fail(header.error());
    }
    if (header->channel_id != channel_id) {
        return fail(status::Bad_TcpSecureChannelUnknown);
    }
    // A token that was only offered counts as used once the chunk under it is verified.
    const bool is_offered = offered_ && offered_->id == header->token_id;
    Token* token = is_offered ? &*offered_ : find_token(header->token_id, now);
    if (token == nullptr) {
        return fail(status::Bad_SecureChannelTokenUnknown);
    }
    auto content = open_symmetric(frame.bytes, security, *token);
    if (content && !received_.accept(content->sequence_number)) {
        environment_.log->write(LogLevel::Warning, "channel", "Bad_SequenceNumberInvalid");
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (content && is_offered) {
        static_cast<void>(find_token(header->token_id, now));
    }
    return content;
}

void Conversation::reset_assembly()
{
    message_ = {};
    message_chunks_ = 0;
}

Result<std::optional<Event>> Conversation::assemble(const Frame& frame,
                                                    const SymmetricContent& content)
{
    if (message_chunks_ != 0 && content.request_id != message_request_id_) {
        return fail(status::Bad_TcpMessageTypeInvalid); // messages do not mix their chunks
    }
    if (frame.header.chunk == 'A') {
        if (message_chunks_ == 0) {
            return fail(status::Bad_TcpMessageTypeInvalid);
        }
        reset_assembly();
        Event event{Event::Kind::Aborted, content.request_id, {}, {}, {}};
        const auto error = parse_abort(content.body);
        event.status = error.error;
        event.reason = printable(error.reason.view());
        return event;
    }
    if (message_chunks_ == limits_.max_chunk_count ||
        content.body.size() > limits_.max_message_size - message_.size()) {
        return fail(status::Bad_TcpMessageTooLarge);
    }
    ++message_chunks_;
    message_request_id_ = content.request_id;
    message_.insert(message_.end(), content.body.begin(), content.body.end());
    if (frame.header.chunk == 'C') {
        return std::nullopt;
    }
    Event event{Event::Kind::Message, content.request_id, std::move(message_), {}, {}};
    reset_assembly();
    return event;
}

bool Conversation::accept_sequence(std::uint32_t number)
{
    return received_.accept(number);
}

Result<void> Conversation::send(MessageType type, std::uint32_t request_id,
                                FunctionRef<void(binary::Writer&)> encode)
{
    const std::size_t position = output_.position();
    const std::uint32_t sequence = sent_.last();
    ChunkSink sink{output_,
                   *current_,
                   sent_,
                   {type, channel_id, request_id, security, sizes_.send_buffer_size,
                    sizes_.max_message_size, sizes_.max_chunk_count, too_large_}};
    binary::Writer writer{sink};
    encode(writer);
    if (!writer.ok() || !sink.finish(writer.filled())) {
        // Nothing of the message has left: the channel is as it was.
        output_.roll_back(position);
        sent_.reset_to(sequence);
        return fail(writer.ok() ? sink.status() : writer.status());
    }
    return {};
}

Result<void> Conversation::send_open(std::uint32_t request_id, std::span<const std::byte> body,
                                     const crypto::Certificate* receiver)
{
    return seal_asymmetric(output_,
                           {channel_id, security.policy, environment_.identity, receiver,
                            sent_.next(), request_id, body},
                           sizes_.send_buffer_size);
}

void Conversation::negotiate(const Hello& agreed)
{
    sizes_.send_buffer_size = std::min(sizes_.send_buffer_size, agreed.receive_buffer_size);
    sizes_.receive_buffer_size = std::min(sizes_.receive_buffer_size, agreed.send_buffer_size);
    sizes_.max_message_size = stricter(agreed.max_message_size, limits_.max_message_size);
    sizes_.max_chunk_count = stricter(agreed.max_chunk_count, limits_.max_chunk_count);
    max_frame_size = sizes_.receive_buffer_size;
}

void Conversation::use(Token token)
{
    previous_ = std::exchange(current_, std::move(token));
    offered_.reset();
}

void Conversation::offer(Token token)
{
    if (!current_) {
        current_ = std::move(token);
        return;
    }
    offered_ = std::move(token);
}

TimePoint Conversation::expires_at() const
{
    const TimePoint current = current_ ? current_->expires_at : no_deadline;
    return offered_ ? std::max(current, offered_->expires_at) : current;
}

TimePoint Conversation::renew_at() const
{
    return current_ ? current_->renew_at : no_deadline;
}

} // namespace busbar::channel::detail
