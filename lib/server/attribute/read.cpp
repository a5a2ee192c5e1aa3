#include "read.hpp"

#include "server/session/session_rights.hpp"

namespace busbar::server::detail {

void ReadOperation::start(ServiceContext& context)
{
    const StatusCode refusal = check_read(request(), needs_.limits.operations.max_nodes_per_read);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    const ReadingUser reader{context.session->user, is_encrypted(*context.session)};
    const auto live_value = [&](const NodeId& node) {
        return needs_.live_values.find(node, reader);
    };
    job_.emplace(ReadContext{needs_.space, needs_.sources,
                             rights_of(*context.session, needs_.space, needs_.access), live_value,
                             needs_.wall_clock.now(), response_limit()},
                 request());
    if (!job_->fits()) {
        job_.reset();
        return fault(status::Bad_ResponseTooLarge);
    }
    if (job_->start(*this, context.now)) {
        return call_completed();
    }
    // Only what waits is held at the session's expense.
    const std::size_t cost = request().nodes_to_read.size() * ReadJob::bytes_per_item;
    if (!charge(cost)) {
        job_.reset();
        return fault(status::Bad_TooManyOperations);
    }
}

TimePoint ReadOperation::next_deadline() const
{
    return job_ ? job_->next_deadline() : no_deadline;
}

void ReadOperation::handle_deadline(TimePoint now)
{
    if (job_ && !is_finished() && job_->handle_deadline(now)) {
        call_completed();
    }
}

void ReadOperation::call_completed()
{
    job_->finish();
    respond<ReadResponse>([&](binary::Writer& writer) { job_->encode_results(writer); });
}

} // namespace busbar::server::detail
