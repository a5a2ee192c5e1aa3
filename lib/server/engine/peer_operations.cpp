#include "peer_link.hpp"

#include <utility>

namespace busbar::server::detail {

namespace {

Refusal takes_too_little(const ServerLimits& limits)
{
    return {status::Bad_TcpNotEnoughResources, "send queue",
            "more than " + std::to_string(limits.max_send_queue) + " bytes wait for the peer",
            "limit max_send_queue", "Let the client ask for less at once"};
}

} // namespace

/// Unfinished operations continue before anything else begins.
void PeerLink::give_turns(TimePoint now)
{
    for (std::size_t i = 0; i < operations_.size() && !turn_.is_over() && has_room(); ++i) {
        ServiceOperation& operation = *operations_[i];
        if (operation.wants_turn()) {
            ServiceContext context{*this, operation.session(), now};
            const RequestFault::Serving serving{core_.guards.request(), this,
                                                operation.request_id()};
            serve(operation, [&] { operation.take_turn(context); });
            if (has_thrown() && !operation.is_finished()) {
                operation.fault(status::Bad_InternalError);
            }
        }
    }
}

bool PeerLink::has_thrown() const
{
    return core_.guards.request().is_noted();
}

ResponseHeader PeerLink::response_header(const Reply& reply, StatusCode status) const
{
    ResponseHeader header;
    header.timestamp = core_.environment.wall_clock->now();
    header.request_handle = reply.request_handle;
    header.service_result = status;
    return header;
}

void PeerLink::respond(const Reply& reply, std::uint32_t encoding_id,
                       FunctionRef<void(binary::Writer&)> encode_response)
{
    const StatusCode thrown = core_.guards.request().answer(this, reply.request_id, status::Good);
    if (thrown.is_bad()) {
        return fault(reply, thrown);
    }
    Result<void> sent;
    const StatusCode failed = busbar::detail::guarded(log_, "a response", [&] {
        sent = channel_.send(reply.request_id, [&](binary::Writer& writer) {
            encode(writer, NodeId{0, encoding_id});
            encode_response(writer);
            turn_.spend(writer.written());
            if (reply.max_size != 0 && writer.written() > reply.max_size) {
                writer.fail(status::Bad_ResponseTooLarge); // Part 4, 5.7.2.2
            }
        });
    });
    if (failed.is_bad() || !sent) {
        return fault(reply, failed.is_bad() ? failed : sent.error());
    }
    answered(reply);
}

void PeerLink::fault(const Reply& reply, StatusCode status)
{
    const StatusCode answer = core_.guards.request().answer(this, reply.request_id, status);
    survive([&] {
        // It fails only if the channel is closed, or too small for any answer.
        static_cast<void>(channel_.send(reply.request_id, [&](binary::Writer& writer) {
            encode(writer, NodeId{0, ServiceFault::binary_encoding_id});
            ReturnDiagnostics diagnostics{reply.return_diagnostics};
            ResponseHeader header = response_header(reply, answer);
            header.service_diagnostics = diagnostics.of_service(answer);
            header.string_table = diagnostics.string_table();
            encode(writer, header);
        }));
    });
    answered(reply);
}

void PeerLink::answered(const Reply& reply)
{
    if (unanswered_ == reply.request_id) {
        unanswered_.reset();
    }
    check_send_queue();
    mark();
}

void PeerLink::count_fault(Session* session, std::uint32_t encoding_id, StatusCode status)
{
    busbar::detail::attempt([&] { core_.counters.count_fault(session, encoding_id, status); });
}

void PeerLink::start(std::unique_ptr<ServiceOperation> operation, std::vector<std::byte> message,
                     std::size_t offset, const Question& question, ServiceContext& context)
{
    const StatusCode bad = operation->decode(std::move(message), offset, core_.types,
                                             core_.limits().decode, &core_.kept_memory);
    if (bad.is_bad()) {
        return fault(question.reply, bad);
    }
    operations_.push_back(std::move(operation));
    ServiceOperation& started = *operations_.back();
    started.open(question, context);
    serve(started, [&] {
        if (!started.replace_aliases()) {
            return started.fault(status::Bad_TooManyOperations);
        }
        started.start(context);
    });
    if (core_.guards.request().is_noted()) {
        started.fault(status::Bad_InternalError);
    }
    if (!started.is_finished() && !started.charge_message()) {
        started.fault(status::Bad_TooManyOperations);
    }
    if (started.is_finished()) {
        recycle(started.spare_message());
        operations_.pop_back();
    }
}

bool PeerLink::has_place_for_operation() const
{
    return operations_.size() < core_.limits().max_pending_requests;
}

void PeerLink::end_operations(const Session& session, StatusCode status)
{
    for (const auto& operation : operations_) {
        if (!operation->is_finished() && operation->session() == &session) {
            operation->fault(status);
        }
    }
}

void PeerLink::begin_shutdown()
{
    for (const auto& operation : operations_) {
        if (!operation->is_finished() && !operation->outlasts_shutdown()) {
            operation->fault(status::Bad_Shutdown);
        }
    }
}

std::uint32_t PeerLink::cancel(const Session& session, std::uint32_t request_handle)
{
    std::uint32_t count = 0;
    for (const auto& operation : operations_) {
        if (!operation->is_finished() && operation->session() == &session &&
            operation->request_handle() == request_handle) {
            operation->fault(status::Bad_RequestCancelledByClient);
            ++count;
        }
    }
    return count;
}

void PeerLink::wants_sweep()
{
    if (!std::exchange(waits_for_sweep_, true)) {
        core_.to_sweep.push_back(this);
    }
}

void PeerLink::sweep()
{
    waits_for_sweep_ = false;
    std::erase_if(operations_, [&](const auto& operation) {
        if (!operation->is_finished()) {
            return false;
        }
        recycle(operation->spare_message());
        return true;
    });
}

void PeerLink::check_send_queue()
{
    if (!is_closed() && channel_.unsent_size() > core_.limits().max_send_queue) {
        survive([&] { close(takes_too_little(core_.limits())); });
    }
}

void PeerLink::mark()
{
    if (!is_running_) {
        core_.changed.splice(core_.changed.end(), mark_);
    }
}

} // namespace busbar::server::detail
