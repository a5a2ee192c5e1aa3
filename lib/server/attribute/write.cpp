#include "write.hpp"

#include "server/session/session_rights.hpp"

namespace busbar::server::detail {

WriteOperation::~WriteOperation()
{
    if (job_) {
        job_->keep(take_request(), take_message());
    }
}

void WriteOperation::start(ServiceContext& context)
{
    const StatusCode refusal = check_write(request(), needs_.limits.operations.max_nodes_per_write);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    // Before anything is written, as batches cannot be taken back.
    const std::size_t cost = request().nodes_to_write.size() * WriteJob::bytes_per_item;
    if (!charge(cost)) {
        return fault(status::Bad_TooManyOperations);
    }
    job_.emplace(WriteContext{needs_.space, needs_.sources,
                              rights_of(*context.session, needs_.space, needs_.access),
                              *needs_.definitions},
                 request());
    const bool is_complete = job_->start(*this, context.now);
    needs_.observer.kept_values_written();
    if (is_complete) {
        call_completed();
    }
}

TimePoint WriteOperation::next_deadline() const
{
    return job_ ? job_->next_deadline() : no_deadline;
}

void WriteOperation::handle_deadline(TimePoint now)
{
    if (job_ && !is_finished() && job_->handle_deadline(now)) {
        call_completed();
    }
}

void WriteOperation::call_completed()
{
    needs_.observer.written(request(), [this](std::size_t index) { return job_->result(index); });
    respond<WriteResponse>([&](binary::Writer& writer) { job_->encode_results(writer); });
}

} // namespace busbar::server::detail
