#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>

#include "service.hpp"
#include "session.hpp"

namespace busbar::server::detail {

Peer& ServiceOperation::finish()
{
    Peer& peer = *std::exchange(peer_, nullptr);
    if (session_ != nullptr) {
        session_->release(charged_);
        --session_->pending_operations;
        session_ = nullptr;
    }
    peer.wants_sweep();
    return peer;
}

void ServiceOperation::respond(std::uint32_t encoding_id, FunctionRef<void(binary::Writer&)> encode,
                               const ReturnDiagnostics* diagnostics, StatusCode result)
{
    if (!is_finished()) {
        const Reply reply{request_id_, request_handle_,
                          session_ != nullptr ? session_->max_response_message_size : 0,
                          return_diagnostics_};
        Peer& peer = finish();
        peer.respond(reply, encoding_id, [&](binary::Writer& writer) {
            ResponseHeader header = peer.response_header(reply, result);
            if (diagnostics != nullptr) {
                header.string_table = diagnostics->string_table();
            }
            busbar::encode(writer, header);
            encode(writer);
        });
    }
}

void ServiceOperation::drop()
{
    busbar::detail::attempt([&] { ends_with(status::Bad_ConnectionClosed); });
    static_cast<void>(finish());
}

void ServiceOperation::fault(StatusCode status)
{
    if (!is_finished()) {
        busbar::detail::attempt([&] { ends_with(status); });
        peer_->count_fault(session_, encoding_id_, status);
        finish().fault({request_id_, request_handle_, 0, return_diagnostics_}, status);
    }
}

void ServiceOperation::deadline_changed()
{
    if (!is_finished()) {
        peer_->mark();
    }
}

std::size_t ServiceOperation::response_limit() const
{
    const std::size_t of_session = session_ != nullptr ? session_->max_response_message_size : 0;
    const std::size_t of_channel = peer_ != nullptr ? peer_->max_response_size() : 0;
    return of_session == 0 ? of_channel : std::min(of_session, of_channel);
}

bool ServiceOperation::charge(std::size_t bytes)
{
    if (session_ != nullptr && !session_->charge(bytes)) {
        return false;
    }
    charged_ += bytes;
    return true;
}

bool ServiceOperation::replace_aliases()
{
    if (session_ == nullptr || session_->registered == nullptr || takes_aliases()) {
        return true;
    }
    return visit_node_ids([&](NodeId& id) {
        const auto canonical = session_->registered->canonical(id);
        if (canonical && !charge(binary::encoded_size(*canonical))) {
            return false;
        }
        if (canonical) {
            id = *canonical; // a copy owns its memory
        }
        return true;
    });
}

StatusCode ServiceOperation::decode(std::vector<std::byte> message, std::size_t offset,
                                    const binary::TypeRegistry& types,
                                    const binary::DecodeLimits& limits,
                                    busbar::detail::KeptMemory* memory)
{
    memory_ = memory;
    message_ = std::move(message);
    binary::Reader reader{std::span{message_}.subspan(offset), binary::Strings::Borrow, &types,
                          limits};
    reader.keep_memory_in(memory);
    decode_request(reader);
    decoded_ = reader.charged();
    if (reader.ok() && reader.remaining() != 0) {
        return status::Bad_DecodingError;
    }
    return reader.ok() ? StatusCode{} : reader.status();
}

void ServiceOperation::open(const Question& question, ServiceContext& context)
{
    peer_ = &context.peer;
    session_ = context.session;
    if (session_ != nullptr) {
        ++session_->pending_operations;
    }
    encoding_id_ = question.encoding_id;
    request_id_ = question.reply.request_id;
    request_handle_ = question.reply.request_handle;
    return_diagnostics_ = question.reply.return_diagnostics;
    if (question.timeout_hint != 0) {
        client_deadline_ = context.now + std::chrono::milliseconds{question.timeout_hint};
    }
}

} // namespace busbar::server::detail
