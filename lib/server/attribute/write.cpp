#include "write.hpp"

#include "server/engine/core.hpp"
#include "server/session/session.hpp"
#include "server/session/session_rights.hpp"
#include "server/subscription/semantic_changes.hpp"

namespace busbar::server::detail {

WriteOperation::~WriteOperation()
{
    if (job_) {
        job_->keep(take_request(), take_message());
    }
}

void WriteOperation::start(ServiceContext& context)
{
    Core& core = context.core;
    core_ = &core;
    const StatusCode refusal = check_write(request(), core.limits().operations.max_nodes_per_write);
    if (refusal.is_bad()) {
        return fault(refusal);
    }
    // Before anything is written, as batches cannot be taken back.
    const std::size_t cost = request().nodes_to_write.size() * WriteJob::bytes_per_item;
    if (!charge(cost)) {
        return fault(status::Bad_TooManyOperations);
    }
    job_.emplace(WriteContext{core.address_space, core.sources, rights_of(context),
                              &core.data_types, core.limits().decode},
                 request());
    const bool is_complete = job_->start(*this, context.now);
    core.diagnostics.take_flag(core.address_space);
    core.session_nodes.take_flag(core);
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
    announce_semantic_changes(*core_, request(),
                              [this](std::size_t index) { return job_->result(index); });
    respond<WriteResponse>([&](binary::Writer& writer) { job_->encode_results(writer); });
}

} // namespace busbar::server::detail
