#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "publish_queue.hpp"
#include "server/session/session.hpp"
#include "server/session/session_record.hpp"
#include "subscription.hpp"
#include "subscription_services.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

namespace {

/// ClientValidated(): the same user or, if no user logged in, the same application over a channel
/// that proves its identity (Part 4, 5.14.7.1).
bool is_same_client(const SubscriptionOwner& owner, const Session& session)
{
    if (!is_same_user(owner.user, session.user)) {
        return false;
    }
    if (session.user.token_type != UserTokenType::Anonymous) {
        return true;
    }
    return owner.is_signed && session.security.mode != MessageSecurityMode::None &&
           owner.application_uri == session.client_application_uri;
}

StatusCode transfer(const SubscriptionTable& all, const ServiceContext& context,
                    Subscription& subscription, bool sends_initial_values)
{
    Session& session = *context.session;
    subscription.count(&SubscriptionDiagnosticsDataType::transfer_request_count);
    const bool is_same_application =
        subscription.owner().application_uri == session.client_application_uri;
    const bool is_validated = is_same_client(subscription.owner(), session);
    if (is_validated && subscription.session() != &session &&
        (PublishPart::of(session).subscriptions().size() >=
             all.needs().limits.subscriptions.max_subscriptions_per_session ||
         !all.has_share_for(subscription, session))) {
        return status::Bad_TooManySubscriptions;
    }
    const SubscriptionRow& row = subscription.handle(
        SubscriptionEvent::TransferSubscriptions,
        {.now = context.now, .session = &session, .is_client_validated = is_validated});
    if (row.is_refusal) {
        return subscription.session() == &session ? status::Bad_NothingToDo
                                                  : status::Bad_UserAccessDenied;
    }
    subscription.count(is_same_application
                           ? &SubscriptionDiagnosticsDataType::transferred_to_same_client_count
                           : &SubscriptionDiagnosticsDataType::transferred_to_alt_client_count);
    if (sends_initial_values) {
        busbar::detail::attempt([&] { subscription.resend_data(context.now); });
    }
    return status::Good;
}

void tell_transferred(LogSink& log, const ServiceContext& context, StatusCode status)
{
    if (!log.wants(RecordKind::SubscriptionsTransferred)) {
        return;
    }
    Record record{RecordKind::SubscriptionsTransferred, LogLevel::Debug, "subscription"};
    record.actor = actor_of(*context.session, context.mark);
    record.status = status;
    log.record(record);
}

/// Returns Good, or the first other status.
StatusCode status_of_all(const Array<TransferResult>& results)
{
    for (const TransferResult& result : results) {
        if (!result.status_code.is_good()) {
            return result.status_code;
        }
    }
    return status::Good;
}

} // namespace

StatusCode transfer_subscriptions(SubscriptionTable& all, ServiceContext& context,
                                  const TransferSubscriptionsRequest& request,
                                  TransferSubscriptionsResponse& response)
{
    if (const StatusCode bad = check_count(all.needs().limits, request.subscription_ids.size());
        bad.is_bad()) {
        tell_transferred(all.needs().log, context, bad);
        return bad;
    }
    response.results.reserve(request.subscription_ids.size());
    for (const std::uint32_t id : request.subscription_ids) {
        TransferResult result;
        Subscription* const subscription = all.find(id);
        Array<std::uint32_t> available;
        if (subscription != nullptr) { // before it moves, which is not undone
            available = Array<std::uint32_t>{subscription->retransmission().available()};
        }
        result.status_code = subscription == nullptr ? status::Bad_SubscriptionIdInvalid
                                                     : transfer(all, context, *subscription,
                                                                request.send_initial_values);
        if (result.status_code.is_good()) {
            result.available_sequence_numbers = std::move(available);
        }
        response.results.push_back(std::move(result));
    }
    tell_transferred(all.needs().log, context, status_of_all(response.results));
    // Publish requests of the session may have waited for the Notifications of these.
    busbar::detail::attempt([&] { PublishPart::of(*context.session).serve(context.now); });
    return status::Good;
}

} // namespace busbar::server::detail
