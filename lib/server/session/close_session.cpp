#include "server/engine/link.hpp"
#include "session_services.hpp"

namespace busbar::server::detail {

StatusCode close_session(ServiceContext& context, const CloseSessionRequest& request,
                         CloseSessionResponse&)
{
    // Part 4, 5.7.4.1: also before it was activated, but only over its own channel.
    if (context.session->link != &context.link) {
        return status::Bad_SecureChannelIdInvalid;
    }
    context.core.close_session(*context.session, status::Bad_SessionClosed,
                               request.delete_subscriptions);
    context.session = nullptr;
    return status::Good;
}

StatusCode cancel(ServiceContext& context, const CancelRequest& request, CancelResponse& response)
{
    // The session may have brought requests from an earlier channel with it.
    for (Link* link : context.core.links) {
        response.cancel_count += link->cancel(*context.session, request.request_handle);
    }
    return status::Good;
}

} // namespace busbar::server::detail
