#include "conversation.hpp"

#include <algorithm>
#include <utility>

#include <busbar/channel/spare_buffers.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "buffer_bounds.hpp"

namespace busbar::channel::detail {

namespace {

/// 0 means "no limit" for the peer; we always have one (Part 6, 7.1.2.3).
std::uint32_t stricter(std::uint32_t peer, std::uint32_t own)
{
    return peer == 0 ? own : std::min(peer, own);
}

} // namespace

Conversation::Conversation(const TransportLimits& limits, const ChannelEnvironment& environment,
                           Role role, SpareBuffers* spares)
    : limits_{completed(limits)}, environment_{environment}, role_{role}, spares_{spares},
      output_{spares}, assembly_{limits_, environment.budget, spares}
{
    sizes_.receive_buffer_size = limits_.receive_buffer_size;
    sizes_.send_buffer_size = limits_.send_buffer_size;
    sizes_.max_message_size = limits_.max_message_size;
    sizes_.max_chunk_count = limits_.max_chunk_count;
}

Conversation::~Conversation()
{
    if (spares_ != nullptr) {
        spares_->give_back_input(std::move(input_));
    }
}

/// All input was processed, or there is none yet.
void Conversation::input_is_done()
{
    input_.clear();
    input_begin_ = 0;
    if (spares_ != nullptr) {
        spares_->give_back_input(std::exchange(input_, {}));
    } else if (input_.capacity() > max_idle_input) {
        input_ = {};
    }
}

void Conversation::feed(std::span<const std::byte> in)
{
    if (input_begin_ == input_.size()) {
        input_is_done();
        if (spares_ != nullptr) {
            input_ = spares_->take_input();
        }
    } else if (input_begin_ > input_.size() / 2) {
        input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(input_begin_));
        input_begin_ = 0;
    }
    input_.insert(input_.end(), in.begin(), in.end());
}

Result<std::optional<Frame>> Conversation::next_frame()
{
    if (spares_ != nullptr && input_begin_ == input_.size()) {
        input_is_done();
    }
    const auto waiting = std::span{input_}.subspan(input_begin_);
    if (is_held || waiting.size() < header_size) {
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

void Conversation::hold(const Frame& frame)
{
    input_begin_ -= frame.bytes.size();
    is_held = true;
}

Token* Conversation::find_token(std::uint32_t id, TimePoint now)
{
    for (auto* token : {&offered_, &current_, &previous_}) {
        if (*token && (*token)->id == id) {
            return now < (*token)->expires_at ? &**token : nullptr;
        }
    }
    return nullptr;
}

/// Part 4, 5.6.2.1: the first message that the client secures with a new token ends the old one.
void Conversation::note_use(const Token& token)
{
    if (offered_ && &token == &*offered_) {
        current_ = std::exchange(offered_, std::nullopt);
        previous_.reset();
    } else if (role_ == Role::Server && &token == &*current_) {
        previous_.reset();
    }
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
    Token* const token = find_token(header->token_id, now);
    if (token == nullptr) {
        return fail(status::Bad_SecureChannelTokenUnknown);
    }
    auto content = open_symmetric(frame.bytes, security, *token);
    if (!content) {
        return content;
    }
    if (!received_.accept(content->sequence_number)) {
        return fail(status::Bad_SequenceNumberInvalid);
    }
    note_use(*token);
    return content;
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
    const StatusCode too_large =
        role_ == Role::Server ? status::Bad_ResponseTooLarge : status::Bad_RequestTooLarge;
    ChunkSink sink{output_,
                   *current_,
                   sent_,
                   {type, channel_id, request_id, security, sizes_.send_buffer_size,
                    sizes_.max_message_size, sizes_.max_chunk_count, too_large,
                    environment_.chunk_hook}};
    binary::Writer writer{sink};
    // No part of a failed message has left: the channel is as it was.
    busbar::detail::Undo undo{[&] {
        output_.roll_back(position);
        sent_.reset_to(sequence);
    }};
    encode(writer);
    if (!writer.ok() || !sink.finish(writer.filled())) {
        return fail(writer.ok() ? sink.status() : writer.status());
    }
    undo.keep();
    return {};
}

AsymmetricParts Conversation::open_parts(std::uint32_t request_id)
{
    AsymmetricParts parts;
    parts.channel_id = channel_id;
    parts.policy = security.policy;
    parts.sequence_number = sent_.next();
    parts.request_id = request_id;
    return parts;
}

Result<void> Conversation::send_open(std::uint32_t request_id, std::span<const std::byte> body,
                                     const crypto::Certificate* receiver)
{
    AsymmetricParts parts = open_parts(request_id);
    parts.sender = environment_.identity;
    parts.receiver = receiver;
    parts.body = body;
    return seal_asymmetric(output_, parts, sizes_.send_buffer_size);
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
    if (!current_) {
        return no_deadline;
    }
    return offered_ ? current_->ends_at : current_->expires_at;
}

bool Conversation::expire(TimePoint now)
{
    if (offered_ && now >= current_->ends_at) {
        previous_ = std::exchange(current_, std::exchange(offered_, std::nullopt));
    }
    if (previous_ && now >= previous_->expires_at) {
        previous_.reset();
    }
    return current_ && now >= current_->expires_at;
}

std::size_t Conversation::memory_in_use() const
{
    return input_.capacity() + output_.capacity() + assembly_.capacity();
}

TimePoint Conversation::renew_at() const
{
    return current_ ? current_->renew_at : no_deadline;
}

} // namespace busbar::channel::detail
