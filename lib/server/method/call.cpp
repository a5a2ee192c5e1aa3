#include "call.hpp"

namespace busbar::server::detail {

CallOperation::~CallOperation()
{
    if (job_) {
        job_->keep(take_request(), take_message());
    }
}

void CallOperation::start(ServiceContext& context)
{
    mark_ = context.mark;
    const StatusCode refusal =
        check_call(request(), needs_.limits.operations.max_nodes_per_method_call);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    // Before anything is carried out, as it cannot be undone.
    if (!charge(cost_of(request()))) {
        return fault(status::Bad_TooManyOperations);
    }
    job_.emplace(needs_, context, request());
    if (job_->start(*this, context.now)) {
        call_completed();
    }
}

TimePoint CallOperation::next_deadline() const
{
    return job_ ? job_->next_deadline() : no_deadline;
}

void CallOperation::handle_deadline(TimePoint now)
{
    if (job_ && !is_finished() && job_->handle_deadline(now)) {
        call_completed();
    }
}

void CallOperation::ends_with(StatusCode status)
{
    if (job_ && session() != nullptr) {
        job_->record(*session(), mark_, request(), status);
    }
}

void CallOperation::call_completed()
{
    if (is_finished()) {
        return;
    }
    job_->finish();
    if (session() != nullptr) {
        job_->record(*session(), mark_, request());
    }
    if (const StatusCode refusal = job_->service_result(); refusal.is_bad()) {
        return fault(refusal);
    }
    ReturnDiagnostics diagnostics = this->diagnostics();
    const CallDiagnostics told = job_->diagnose(diagnostics, request());
    respond<CallResponse>(diagnostics,
                          [&](binary::Writer& writer) { job_->encode_results(writer, told); });
}

} // namespace busbar::server::detail
