#include "subscription_services.hpp"

#include "server/session/session.hpp"
#include "server/session/sliced_operation.hpp"
#include "subscription.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

namespace {

/// Returns the Subscription, if it belongs to the session.
Result<Subscription*> find(const SubscriptionTable& all, const Session& session, std::uint32_t id)
{
    Subscription* const found = all.find(id);
    if (found == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    if (found->session() != &session) {
        return fail(status::Bad_UserAccessDenied);
    }
    return found;
}

/// A service over a list of Subscriptions, with a status for each.
template <typename Request, typename Response>
class SubscriptionsOperation final : public SlicedOperation<Request, Response> {
public:
    using Work = StatusCode(SubscriptionTable&, ServiceContext&, const Request&, std::uint32_t id);

    SubscriptionsOperation(SubscriptionTable& all, Work& work_on) : all_{all}, work_on_{work_on} {}

private:
    [[nodiscard]] std::size_t size() const override
    {
        return this->request().subscription_ids.size();
    }
    [[nodiscard]] StatusCode begin(ServiceContext&) override
    {
        return check_count(all_.needs().limits, size());
    }
    [[nodiscard]] StatusCode resume(ServiceContext& context) override
    {
        context_ = &context;
        return status::Good;
    }
    [[nodiscard]] std::optional<StatusCode> work(std::size_t index, Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        return work_on_(all_, *context_, this->request(), this->request().subscription_ids[index]);
    }

    SubscriptionTable& all_;
    Work& work_on_;
    /// Valid during its turn.
    ServiceContext* context_{nullptr};
};

StatusCode delete_subscription(SubscriptionTable& all, ServiceContext& context,
                               const DeleteSubscriptionsRequest& /*request*/, std::uint32_t id)
{
    Subscription* const subscription = all.find(id);
    if (subscription == nullptr) {
        return status::Bad_SubscriptionIdInvalid;
    }
    const SubscriptionRow& row = subscription->handle(
        SubscriptionEvent::DeleteSubscriptions, {.now = context.now, .session = context.session});
    if (row.is_refusal) {
        return status::Bad_SubscriptionIdInvalid;
    }
    all.remove(*subscription);
    return status::Good;
}

StatusCode set_publishing_mode(SubscriptionTable& all, ServiceContext& context,
                               const SetPublishingModeRequest& request, std::uint32_t id)
{
    Subscription* const subscription = all.find(id, *context.session);
    if (subscription == nullptr) {
        return status::Bad_SubscriptionIdInvalid;
    }
    subscription->handle(SubscriptionEvent::SetPublishingMode,
                         {.now = context.now, .publishing_enabled = request.publishing_enabled});
    return status::Good;
}

using DeleteSubscriptions =
    SubscriptionsOperation<DeleteSubscriptionsRequest, DeleteSubscriptionsResponse>;
using SetPublishingMode =
    SubscriptionsOperation<SetPublishingModeRequest, SetPublishingModeResponse>;

} // namespace

StatusCode check_count(const ServerLimits& limits, std::size_t count)
{
    if (count == 0) {
        return status::Bad_NothingToDo;
    }
    return count > limits.operations.max_monitored_items_per_call ? status::Bad_TooManyOperations
                                                                  : status::Good;
}

StatusCode create_subscription(SubscriptionTable& all, ServiceContext& context,
                               const CreateSubscriptionRequest& request,
                               CreateSubscriptionResponse& response)
{
    const SubscriptionParameters parameters =
        revise(all.needs().limits.subscriptions, request.requested_publishing_interval,
               request.requested_lifetime_count, request.requested_max_keep_alive_count,
               request.max_notifications_per_publish, request.priority);
    const auto made =
        all.create(*context.session, parameters, request.publishing_enabled, context.now);
    if (!made) {
        return made.error();
    }
    response.subscription_id = (*made)->id();
    response.revised_publishing_interval = to_milliseconds(parameters.publishing_interval);
    response.revised_lifetime_count = parameters.lifetime_count;
    response.revised_max_keep_alive_count = parameters.max_keep_alive_count;
    return status::Good;
}

StatusCode modify_subscription(SubscriptionTable& all, ServiceContext& context,
                               const ModifySubscriptionRequest& request,
                               ModifySubscriptionResponse& response)
{
    Subscription* const subscription = all.find(request.subscription_id, *context.session);
    if (subscription == nullptr) {
        return status::Bad_SubscriptionIdInvalid;
    }
    const SubscriptionParameters parameters =
        revise(all.needs().limits.subscriptions, request.requested_publishing_interval,
               request.requested_lifetime_count, request.requested_max_keep_alive_count,
               request.max_notifications_per_publish, request.priority);
    subscription->handle(SubscriptionEvent::ModifySubscription,
                         {.now = context.now, .parameters = &parameters});
    response.revised_publishing_interval = to_milliseconds(parameters.publishing_interval);
    response.revised_lifetime_count = parameters.lifetime_count;
    response.revised_max_keep_alive_count = parameters.max_keep_alive_count;
    return status::Good;
}

std::unique_ptr<ServiceOperation> make_set_publishing_mode(SubscriptionTable& all)
{
    return std::make_unique<SetPublishingMode>(all, set_publishing_mode);
}

std::unique_ptr<ServiceOperation> make_delete_subscriptions(SubscriptionTable& all)
{
    return std::make_unique<DeleteSubscriptions>(all, delete_subscription);
}

void RepublishOperation::start(ServiceContext& context)
{
    Subscription* const subscription = all_.find(request().subscription_id, *context.session);
    if (subscription == nullptr) {
        return fault(status::Bad_SubscriptionIdInvalid);
    }
    const std::vector<std::byte>* const message =
        subscription->retransmission().find(request().retransmit_sequence_number);
    subscription->count(&SubscriptionDiagnosticsDataType::republish_request_count);
    subscription->handle(SubscriptionEvent::Republish,
                         {.now = context.now, .is_message_found = message != nullptr});
    if (message == nullptr) {
        return fault(status::Bad_MessageNotAvailable);
    }
    subscription->count(&SubscriptionDiagnosticsDataType::republish_message_count);
    respond<RepublishResponse>([&](binary::Writer& writer) { writer.bytes(*message); });
}

Result<MonitoredItemHandles> get_monitored_items(const SubscriptionTable& all,
                                                 const Session& session,
                                                 std::uint32_t subscription_id)
{
    const auto subscription = find(all, session, subscription_id);
    if (!subscription) {
        return fail(subscription.error());
    }
    MonitoredItemHandles handles;
    handles.server_handles.reserve((*subscription)->item_count());
    handles.client_handles.reserve((*subscription)->item_count());
    for (const std::uint32_t id : (*subscription)->item_ids()) {
        handles.server_handles.push_back(id);
        handles.client_handles.push_back((*subscription)->find_item(id)->client_handle());
    }
    return handles;
}

StatusCode resend_data(SubscriptionTable& all, const Session& session,
                       std::uint32_t subscription_id, TimePoint now)
{
    const auto subscription = find(all, session, subscription_id);
    if (!subscription) {
        return subscription.error();
    }
    (*subscription)->reset_lifetime_counter();
    (*subscription)->note_resend();
    all.reviews().begin(**subscription, now);
    return status::Good;
}

} // namespace busbar::server::detail
