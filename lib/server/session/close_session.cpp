#include <array>

#include "session_record.hpp"
#include "session_services.hpp"

namespace busbar::server::detail {

StatusCode close_session(const SessionNeeds& needs, ServiceContext& context,
                         const CloseSessionRequest& request, CloseSessionResponse&)
{
    // Part 4, 5.7.4.1: also before it was activated, but only over its own channel.
    if (context.session->peer != &context.peer) {
        return status::Bad_SecureChannelIdInvalid;
    }
    context.session->end = SessionEnd::CloseSession;
    context.session->end_mark = context.mark;
    needs.keeper.close_session(*context.session, status::Bad_SessionClosed,
                               request.delete_subscriptions);
    context.session = nullptr;
    return status::Good;
}

StatusCode cancel(const SessionNeeds& needs, ServiceContext& context, const CancelRequest& request,
                  CancelResponse& response)
{
    response.cancel_count = needs.keeper.cancel(*context.session, request.request_handle);
    if (needs.log.wants(RecordKind::RequestCancelled)) {
        const std::array fields{RecordField{"RequestHandle", Variant{request.request_handle}}};
        Record record{RecordKind::RequestCancelled, LogLevel::Debug, "session"};
        record.actor = actor_of(*context.session, context.mark);
        record.fields = fields;
        needs.log.record(record);
    }
    return status::Good;
}

} // namespace busbar::server::detail
