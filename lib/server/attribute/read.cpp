#include "read.hpp"

#include <algorithm>

#include "server/session/session.hpp"

namespace busbar::server::detail {

void ReadOperation::start(ServiceContext& context)
{
    const StatusCode refusal = check_read(request(), needs_.limits.operations.max_nodes_per_read);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    job_.emplace(needs_.sources, request(), response_limit());
    take_turn(context);
}

bool ReadOperation::plan(ServiceContext& context)
{
    const ReadingUser reader{context.session->user, is_encrypted(*context.session)};
    const auto live_value = [&](const NodeId& node) {
        return needs_.live_values.find(node, reader);
    };
    const ReadContext what{needs_.space,
                           needs_.sources,
                           rights_of(*context.session, needs_.space, needs_.access),
                           live_value,
                           needs_.wall_clock.now(),
                           needs_.start_time,
                           context.session->locale_ids,
                           context.session->registered.get()};
    if (job_->is_outdated(needs_.space)) {
        // A source must not be asked for a removed variable, nor for one of another source.
        job_.emplace(needs_.sources, request(), response_limit());
        ++restarts_;
    }
    Turn& turn = context.peer.turn();
    Turn longer = turn.prolonged(restarts_);
    const bool is_planned = job_->plan(what, longer);
    turn.spend_as(longer, restarts_);
    return is_planned;
}

void ReadOperation::take_turn(ServiceContext& context)
{
    is_planning_ = !plan(context);
    StatusCode refusal;
    if (context.peer.has_thrown()) {
        refusal = status::Bad_InternalError;
    } else if (!job_->fits()) {
        refusal = status::Bad_ResponseTooLarge;
    } else if (!is_planning_ && job_->start(*this, context.now)) {
        return call_completed();
    } else if (!pay()) {
        refusal = status::Bad_TooManyOperations;
    }
    if (refusal.is_bad()) {
        job_.reset();
        fault(refusal);
    }
}

bool ReadOperation::pay()
{
    const std::size_t more = job_->held() - std::min(paid_, job_->held());
    paid_ += more;
    return charge(more);
}

TimePoint ReadOperation::next_deadline() const
{
    return job_ && !is_planning_ ? job_->next_deadline() : no_deadline;
}

void ReadOperation::handle_deadline(TimePoint now)
{
    if (job_ && !is_planning_ && !is_finished() && job_->handle_deadline(now)) {
        call_completed();
    }
}

void ReadOperation::call_completed()
{
    job_->finish();
    if (const StatusCode refusal = job_->service_result(); refusal.is_bad()) {
        return fault(refusal);
    }
    ReturnDiagnostics diagnostics = this->diagnostics();
    const auto infos = job_->diagnose(diagnostics);
    const DateTime answered = needs_.wall_clock.now();
    respond<ReadResponse>(diagnostics, [&](binary::Writer& writer) {
        job_->encode_results(writer, answered, infos);
    });
}

} // namespace busbar::server::detail
