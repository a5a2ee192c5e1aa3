#include "write.hpp"

#include <utility>

#include "server/session/session.hpp"

namespace busbar::server::detail {

WriteOperation::~WriteOperation()
{
    if (job_) {
        job_->keep(take_request(), take_message());
    }
}

void WriteOperation::start(ServiceContext& context)
{
    mark_ = context.mark;
    const StatusCode refusal = check_write(request(), needs_.limits.operations.max_nodes_per_write);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    // Before anything is written, as batches cannot be undone.
    const std::size_t cost = request().nodes_to_write.size() * WriteJob::bytes_per_item;
    if (!charge(cost)) {
        return fault(status::Bad_TooManyOperations);
    }
    job_.emplace(needs_.sources, request());
    take_turn(context);
}

bool WriteOperation::plan(ServiceContext& context)
{
    const WriteContext what{needs_.space,
                            needs_.sources,
                            rights_of(*context.session, needs_.space, needs_.access),
                            *needs_.definitions,
                            needs_.wall_clock.now(),
                            needs_.locale_ids,
                            context.session->registered.get()};
    if (job_->is_outdated(needs_.space)) {
        // A source must not get the values of another one.
        job_->plan_again();
        ++restarts_;
    }
    Turn& turn = context.peer.turn();
    Turn longer = turn.prolonged(restarts_);
    const bool is_planned = job_->plan(what, longer);
    turn.spend_as(longer, restarts_);
    return is_planned;
}

void WriteOperation::take_turn(ServiceContext& context)
{
    is_planning_ = !plan(context);
    needs_.observer.kept_values_written();
    if (context.peer.has_thrown()) { // before a source gets anything
        return fault(status::Bad_InternalError);
    }
    const bool is_complete = !is_planning_ && job_->start(*this, context.now);
    if (is_complete) {
        call_completed();
    }
}

TimePoint WriteOperation::next_deadline() const
{
    return job_ && !is_planning_ ? job_->next_deadline() : no_deadline;
}

void WriteOperation::handle_deadline(TimePoint now)
{
    if (job_ && !is_planning_ && !is_finished() && job_->handle_deadline(now)) {
        call_completed();
    }
}

void WriteOperation::ends_with(StatusCode status)
{
    if (job_ && session() != nullptr && !std::exchange(is_observed_, true)) {
        needs_.observer.given_up(*session(), mark_, request(), job_->nodes(),
                                 [&](std::size_t index) { return job_->result_or(index, status); });
    }
}

void WriteOperation::call_completed()
{
    is_observed_ = true;
    needs_.observer.written(session(), mark_, request(), job_->nodes(),
                            [this](std::size_t index) { return job_->result(index); });
    if (const StatusCode refusal = job_->service_result(); refusal.is_bad()) {
        return fault(refusal);
    }
    ReturnDiagnostics diagnostics = this->diagnostics();
    const bool is_encrypted =
        session() != nullptr && session()->security.mode == MessageSecurityMode::SignAndEncrypt;
    const auto infos = diagnostics.of_operations(
        request().nodes_to_write.size(), [&](std::size_t index) { return job_->result(index); },
        [&](std::size_t index) { return operand_text(request(), index); },
        [&](std::size_t index) { return is_encrypted ? job_->reason(index) : std::string_view{}; });
    respond<WriteResponse>(diagnostics,
                           [&](binary::Writer& writer) { job_->encode_results(writer, infos); });
}

} // namespace busbar::server::detail
