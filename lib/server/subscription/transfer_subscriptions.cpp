#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "publish_queue.hpp"
#include "server/session/session.hpp"
#include "server/session/session_record.hpp"
#include "server/session/sliced_operation.hpp"
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
        subscription.note_resend();
    }
    if (subscription.is_in_review()) {
        context.peer.turn().spend(Turn::units_of_item *
                                  subscription.all().reviews().begin(subscription, context.now));
    }
    return status::Good;
}

/// TransferSubscriptions (Part 4, 5.14.7), Subscription by Subscription. A move is not undone.
class TransferOperation final
    : public SlicedOperation<TransferSubscriptionsRequest, TransferSubscriptionsResponse> {
public:
    explicit TransferOperation(SubscriptionTable& all) : all_{all} {}

private:
    [[nodiscard]] std::size_t size() const override { return request().subscription_ids.size(); }
    [[nodiscard]] StatusCode begin(ServiceContext& context) override
    {
        mark_ = context.mark;
        return check_count(all_.needs().limits, size());
    }
    [[nodiscard]] StatusCode resume(ServiceContext& context) override
    {
        context_ = &context;
        return status::Good;
    }
    [[nodiscard]] std::optional<TransferResult> work(std::size_t index, Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        TransferResult result;
        Subscription* const subscription = all_.find(request().subscription_ids[index]);
        Array<std::uint32_t> available;
        if (subscription != nullptr) { // before it moves
            available = Array<std::uint32_t>{subscription->retransmission().available()};
        }
        result.status_code = subscription == nullptr ? status::Bad_SubscriptionIdInvalid
                                                     : transfer(all_, *context_, *subscription,
                                                                request().send_initial_values);
        if (result.status_code.is_good()) {
            result.available_sequence_numbers = std::move(available);
        } else if (first_bad_.is_good()) {
            first_bad_ = result.status_code;
        }
        ++done_;
        return result;
    }
    void pause(ServiceContext& context) override
    {
        if (done_ == size() && !context.peer.has_thrown()) { // else the fault is told
            tell(*context.session, first_bad_);
        }
        // Publish requests of the session may have waited for the Notifications of these.
        busbar::detail::attempt([&] { PublishPart::of(*context.session).serve(context.now); });
    }
    void ends_with(StatusCode status) override { tell(*session(), status); }

    void tell(const Session& session, StatusCode status)
    {
        LogSink& log = all_.needs().log;
        if (std::exchange(is_told_, true) || !log.wants(RecordKind::SubscriptionsTransferred)) {
            return;
        }
        Record record{RecordKind::SubscriptionsTransferred, LogLevel::Debug, "subscription"};
        record.actor = actor_of(session, mark_);
        record.status = status;
        log.record(record);
    }

    SubscriptionTable& all_;
    /// Valid during its turn.
    ServiceContext* context_{nullptr};
    RequestMark mark_;
    std::size_t done_{0};
    /// The first status that is not Good.
    StatusCode first_bad_;
    bool is_told_{false};
};

} // namespace

std::unique_ptr<ServiceOperation> make_transfer_subscriptions(SubscriptionTable& all)
{
    return std::make_unique<TransferOperation>(all);
}

} // namespace busbar::server::detail
