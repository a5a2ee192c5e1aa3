#include "link.hpp"

namespace busbar::server::detail {

void Operation::respond(std::uint32_t encoding_id, FunctionRef<void(binary::Writer&)> encode)
{
    if (is_finished()) {
        return;
    }
    Link& link = *link_;
    const Reply reply{request_id_, request_handle_,
                      session_ != nullptr ? session_->max_response_message_size : 0};
    link_ = nullptr;
    session_ = nullptr;
    link.core().needs_sweep = true;
    link.respond(reply, encoding_id, encode);
}

void Operation::fault(StatusCode status)
{
    if (is_finished()) {
        return;
    }
    Link& link = *link_;
    link_ = nullptr;
    session_ = nullptr;
    link.core().needs_sweep = true;
    link.fault({request_id_, request_handle_, 0}, status);
}

void Link::start(std::unique_ptr<Operation> operation, std::vector<std::byte> message,
                 const RequestHeader& header, const Reply& reply, ServiceContext& context)
{
    operation->message_ = std::move(message);
    binary::Reader reader{operation->message_, binary::Strings::Borrow, &core_.types,
                          core_.limits().decode};
    NodeId encoding_id;
    decode(reader, encoding_id);
    operation->decode_request(reader);
    if (!reader.ok() || reader.remaining() != 0) {
        fault(reply, reader.ok() ? status::Bad_DecodingError : reader.status());
        return;
    }
    operation->link_ = this;
    operation->session_ = context.session;
    operation->request_id_ = reply.request_id;
    operation->request_handle_ = reply.request_handle;
    if (header.timeout_hint != 0) {
        operation->client_deadline_ =
            context.now + std::chrono::milliseconds{header.timeout_hint};
    }
    operations_.push_back(std::move(operation));
    // It may have been destroyed with its connection when this returns; it is not looked at again.
    operations_.back()->start(context);
}

} // namespace busbar::server::detail
