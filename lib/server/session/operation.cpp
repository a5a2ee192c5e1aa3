#include <algorithm>

#include "server/engine/link.hpp"

namespace busbar::server::detail {

Link& Operation::finish()
{
    Link& link = *std::exchange(link_, nullptr);
    if (session_ != nullptr) {
        session_->release(charged_);
        --session_->pending_operations;
        session_ = nullptr;
    }
    link.wants_sweep();
    return link;
}

void Operation::respond(std::uint32_t encoding_id, FunctionRef<void(binary::Writer&)> encode)
{
    if (!is_finished()) {
        const Reply reply{request_id_, request_handle_,
                          session_ != nullptr ? session_->max_response_message_size : 0};
        Link& link = finish();
        link.respond(reply, encoding_id, [&](binary::Writer& writer) {
            busbar::encode(writer, link.response_header(reply, status::Good));
            encode(writer);
        });
    }
}

void Operation::fault(StatusCode status)
{
    if (!is_finished()) {
        link_->core().diagnostics.count_fault(session_, encoding_id_, status);
        finish().fault({request_id_, request_handle_, 0}, status);
    }
}

void Operation::deadline_changed()
{
    if (!is_finished()) {
        link_->mark();
    }
}

std::size_t Operation::response_limit() const
{
    const std::size_t of_session = session_ != nullptr ? session_->max_response_message_size : 0;
    const std::size_t of_channel = link_ != nullptr ? link_->channel().max_response_size() : 0;
    return of_session == 0 ? of_channel : std::min(of_session, of_channel);
}

bool Operation::charge(std::size_t bytes)
{
    if (session_ != nullptr && !session_->charge(bytes)) {
        return false;
    }
    charged_ += bytes;
    return true;
}

void Link::start(std::unique_ptr<Operation> operation, std::vector<std::byte> message,
                 std::size_t offset, const Question& question, ServiceContext& context)
{
    operation->message_ = std::move(message);
    binary::Reader reader{std::span{operation->message_}.subspan(offset), binary::Strings::Borrow,
                          &core_.types, core_.limits().decode};
    operation->decode_request(reader);
    if (!reader.ok() || reader.remaining() != 0) {
        fault(question.reply, reader.ok() ? status::Bad_DecodingError : reader.status());
        return;
    }
    operation->link_ = this;
    operation->session_ = context.session;
    if (context.session != nullptr) {
        ++context.session->pending_operations;
    }
    operation->encoding_id_ = question.encoding_id;
    operation->request_id_ = question.reply.request_id;
    operation->request_handle_ = question.reply.request_handle;
    if (question.timeout_hint != 0) {
        operation->client_deadline_ =
            context.now + std::chrono::milliseconds{question.timeout_hint};
    }
    operations_.push_back(std::move(operation));
    Operation& started = *operations_.back();
    started.start(context);
    if (const RequestFault& thrown = core_.guards.request(); thrown.is_noted()) {
        started.fault(status::Bad_InternalError);
    }
    if (!started.is_finished() && !started.charge(started.message_.capacity())) {
        started.fault(status::Bad_TooManyOperations);
    }
    if (started.is_finished()) {
        operations_.pop_back();
    }
}

} // namespace busbar::server::detail
