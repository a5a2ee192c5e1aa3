#include "monitored_item_services.hpp"

#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "sampler.hpp"
#include "server/rights/nodes_ahead.hpp"
#include "server/session/session.hpp"
#include "server/session/sliced_operation.hpp"
#include "subscription.hpp"
#include "subscription_services.hpp"
#include "subscription_table.hpp"
#include "value_item.hpp"

namespace busbar::server::detail {

namespace {

bool is_known(MonitoringMode mode)
{
    return mode >= MonitoringMode::Disabled && mode <= MonitoringMode::Reporting;
}

bool is_known(TimestampsToReturn timestamps)
{
    return timestamps >= TimestampsToReturn::Source && timestamps <= TimestampsToReturn::Neither;
}

/// Returns the session's Subscription, whose client has thereby proved to be alive; else the reason
/// why the request, which has `count` operations, is refused.
Result<Subscription*> find_subscription(SubscriptionTable& all, const ServiceContext& context,
                                        std::uint32_t id, std::size_t count)
{
    Subscription* const subscription = all.find(id, *context.session);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    subscription->reset_lifetime_counter();
    if (const StatusCode bad = check_count(all.needs().limits, count); bad.is_bad()) {
        return fail(bad);
    }
    return subscription;
}

bool is_full(const ItemContext& context)
{
    const SubscriptionLimits& limits = context.all.needs().limits.subscriptions;
    return context.subscription.item_count() >= limits.max_items_per_subscription ||
           !context.all.make_room_for_item(context.subscription, context.now);
}

std::unique_ptr<MonitoredItem> make_item(const ItemContext& context,
                                         const MonitoredItemCreateRequest& request,
                                         TimestampsToReturn timestamps, ItemRevision& revision)
{
    if (!is_known(request.monitoring_mode)) {
        revision.status = status::Bad_MonitoringModeInvalid;
        return nullptr;
    }
    if (is_full(context)) {
        revision.status = status::Bad_TooManyMonitoredItems;
        return nullptr;
    }
    const auto attribute = static_cast<AttributeId>(request.item_to_monitor.attribute_id);
    if (attribute == AttributeId::EventNotifier) {
        EventItems* const events = context.all.needs().event_items;
        revision.status = status::Bad_NotSupported;
        return events != nullptr ? events->make(context, request, revision) : nullptr;
    }
    return ValueItem::make(context, request, timestamps, revision);
}

MonitoredItemCreateResult create_one(const ItemContext& context,
                                     const MonitoredItemCreateRequest& request,
                                     TimestampsToReturn timestamps)
{
    ItemRevision revision;
    MonitoredItemCreateResult result;
    std::unique_ptr<MonitoredItem> made;
    // Deleted items make room, a few for each new item.
    constexpr int most_rounds = 8;
    int rounds = 0;
    do {
        revision = {};
        made = make_item(context, request, timestamps, revision);
    } while (revision.status == status::Bad_TooManyMonitoredItems && ++rounds < most_rounds &&
             context.all.sweep_ended());
    result.status_code = revision.status;
    result.filter_result = std::move(revision.filter_result);
    if (made == nullptr) {
        return result;
    }
    MonitoredItem& item = context.subscription.add_item(std::move(made));
    busbar::detail::Undo undo{
        [&] { static_cast<void>(context.subscription.remove_item(item.id())); }};
    result.monitored_item_id = item.id();
    result.revised_sampling_interval = revision.sampling_interval;
    result.revised_queue_size = revision.queue_size;
    if (item.kind() == MonitoredItem::Kind::Data && item.mode() != MonitoringMode::Disabled) {
        context.all.sampler().add(static_cast<ValueItem&>(item), context.now);
    }
    undo.keep();
    return result;
}

/// Returns the result of SetTriggering for one of its links.
StatusCode add_link(Subscription& subscription, MonitoredItem& trigger, std::uint32_t id,
                    std::size_t max_links)
{
    MonitoredItem* const triggered = subscription.find_item(id);
    return triggered == nullptr ? StatusCode{status::Bad_MonitoredItemIdInvalid}
                                : trigger.add_link(*triggered, max_links);
}

StatusCode remove_link(Subscription& subscription, MonitoredItem& trigger, std::uint32_t id)
{
    MonitoredItem* const triggered = subscription.find_item(id);
    return triggered != nullptr && trigger.remove_link(*triggered)
               ? status::Good
               : status::Bad_MonitoredItemIdInvalid;
}

/// A service over a list of a Subscription's items.
template <typename Request, typename Response>
class ItemsOperation : public SlicedOperation<Request, Response> {
public:
    explicit ItemsOperation(SubscriptionTable& all) : all_{all} {}

protected:
    /// Returns Good, or why the request is refused for a reason other than its Subscription and its
    /// size.
    [[nodiscard]] virtual StatusCode check() const { return status::Good; }
    [[nodiscard]] Subscription& subscription() const { return *subscription_; }
    [[nodiscard]] ItemContext item_context() const { return {all_, *subscription_, now_}; }
    /// The session pays for additional results; they are left out if it cannot.
    [[nodiscard]] ExtensionObject paid_for(ExtensionObject filter_result)
    {
        // Objects are larger than their encoding by at most their fields' headers.
        if (filter_result.is_null() || this->charge(64 + 8 * binary::encoded_size(filter_result))) {
            return filter_result;
        }
        return {};
    }

private:
    [[nodiscard]] StatusCode begin(ServiceContext& context) override
    {
        const auto found =
            find_subscription(all_, context, this->request().subscription_id, this->size());
        return found ? check() : found.error();
    }
    [[nodiscard]] StatusCode resume(ServiceContext& context) override
    {
        now_ = context.now;
        subscription_ = all_.find(this->request().subscription_id, *context.session);
        return subscription_ == nullptr ? status::Bad_SubscriptionIdInvalid : status::Good;
    }
    void pause(ServiceContext&) override
    {
        subscription_ = nullptr;
        // Items without a first sample now are sampled with the others of their interval.
        busbar::detail::attempt([&] { all_.sampler().sample_new(now_); });
    }

    SubscriptionTable& all_;
    /// Valid during its turn.
    Subscription* subscription_{nullptr};
    TimePoint now_;
};

class CreateItems final
    : public ItemsOperation<CreateMonitoredItemsRequest, CreateMonitoredItemsResponse> {
public:
    using ItemsOperation::ItemsOperation;

private:
    [[nodiscard]] std::size_t size() const override { return request().items_to_create.size(); }
    [[nodiscard]] StatusCode check() const override
    {
        return is_known(request().timestamps_to_return) ? status::Good
                                                        : status::Bad_TimestampsToReturnInvalid;
    }
    [[nodiscard]] std::optional<MonitoredItemCreateResult> work(std::size_t index,
                                                                Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        fetch_ahead(item_context().all.needs().space, request().items_to_create.span(), index,
                    [](const MonitoredItemCreateRequest& item) -> const NodeId& {
                        return item.item_to_monitor.node_id;
                    });
        MonitoredItemCreateResult result = create_one(
            item_context(), request().items_to_create[index], request().timestamps_to_return);
        result.filter_result = paid_for(std::move(result.filter_result));
        return result;
    }
    void undo(const CreateMonitoredItemsResponse& response) override
    {
        for (const MonitoredItemCreateResult& made : response.results) {
            static_cast<void>(subscription().remove_item(made.monitored_item_id));
        }
    }
};

class ModifyItems final
    : public ItemsOperation<ModifyMonitoredItemsRequest, ModifyMonitoredItemsResponse> {
public:
    using ItemsOperation::ItemsOperation;

private:
    [[nodiscard]] std::size_t size() const override { return request().items_to_modify.size(); }
    [[nodiscard]] StatusCode check() const override
    {
        return is_known(request().timestamps_to_return) ? status::Good
                                                        : status::Bad_TimestampsToReturnInvalid;
    }
    [[nodiscard]] std::optional<MonitoredItemModifyResult> work(std::size_t index,
                                                                Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        const MonitoredItemModifyRequest& change = request().items_to_modify[index];
        ItemRevision revision;
        if (MonitoredItem* item = subscription().find_item(change.monitored_item_id)) {
            item->modify(item_context(), change.requested_parameters,
                         request().timestamps_to_return, revision);
        } else {
            revision.status = status::Bad_MonitoredItemIdInvalid;
        }
        return MonitoredItemModifyResult{revision.status, revision.sampling_interval,
                                         revision.queue_size,
                                         paid_for(std::move(revision.filter_result))};
    }
};

class SetItemsMode final
    : public ItemsOperation<SetMonitoringModeRequest, SetMonitoringModeResponse> {
public:
    using ItemsOperation::ItemsOperation;

private:
    [[nodiscard]] std::size_t size() const override { return request().monitored_item_ids.size(); }
    [[nodiscard]] StatusCode check() const override
    {
        return is_known(request().monitoring_mode) ? status::Good
                                                   : status::Bad_MonitoringModeInvalid;
    }
    [[nodiscard]] std::optional<StatusCode> work(std::size_t index, Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        MonitoredItem* const item = subscription().find_item(request().monitored_item_ids[index]);
        if (item == nullptr) {
            return status::Bad_MonitoredItemIdInvalid;
        }
        item->set_mode(item_context(), request().monitoring_mode);
        return status::Good;
    }
};

class DeleteItems final
    : public ItemsOperation<DeleteMonitoredItemsRequest, DeleteMonitoredItemsResponse> {
public:
    using ItemsOperation::ItemsOperation;

private:
    [[nodiscard]] std::size_t size() const override { return request().monitored_item_ids.size(); }
    [[nodiscard]] std::optional<StatusCode> work(std::size_t index, Turn& turn) override
    {
        turn.spend(Turn::units_of_item);
        return subscription().remove_item(request().monitored_item_ids[index])
                   ? status::Good
                   : status::Bad_MonitoredItemIdInvalid;
    }
};

/// SetTriggering (Part 4, 5.13.5), link by link: links are removed before others are added.
class SetTriggering final : public OperationOf<SetTriggeringRequest> {
public:
    explicit SetTriggering(SubscriptionTable& all) : all_{all} {}

    void start(ServiceContext& context) override
    {
        const std::size_t count = request().links_to_remove.size() + request().links_to_add.size();
        const auto found = find_subscription(all_, context, request().subscription_id, count);
        if (!found) {
            return fault(found.error());
        }
        if (!charge(count * sizeof(StatusCode))) { // before anything is done
            return fault(status::Bad_TooManyOperations);
        }
        response_.remove_results.reserve(request().links_to_remove.size());
        response_.add_results.reserve(request().links_to_add.size());
        take_turn(context);
    }
    [[nodiscard]] bool wants_turn() const override { return !is_finished(); }
    void take_turn(ServiceContext& context) override
    {
        // Between two turns either may have been deleted.
        Subscription* const subscription = all_.find(request().subscription_id, *context.session);
        if (subscription == nullptr) {
            return fault(status::Bad_SubscriptionIdInvalid);
        }
        MonitoredItem* const trigger = subscription->find_item(request().triggering_item_id);
        if (trigger == nullptr) {
            return fault(status::Bad_MonitoredItemIdInvalid);
        }
        Turn& turn = context.peer.turn();
        while (!is_complete() && !turn.is_over() && !context.peer.has_thrown()) {
            turn.spend(units_of_link);
            work_on_next(*subscription, *trigger);
        }
        if (context.peer.has_thrown()) {
            return fault(status::Bad_InternalError);
        }
        if (is_complete()) {
            ReturnDiagnostics all = diagnostics();
            diagnose(all, request(), response_);
            respond<SetTriggeringResponse>(all, [&](binary::Writer& writer) {
                encode(writer, response_.add_results);
                encode(writer, response_.add_diagnostic_infos);
                encode(writer, response_.remove_results);
                encode(writer, response_.remove_diagnostic_infos);
            });
        }
    }

private:
    /// The links of an item are looked through.
    static constexpr std::size_t units_of_link = 50;

    [[nodiscard]] bool is_complete() const
    {
        return response_.remove_results.size() == request().links_to_remove.size() &&
               response_.add_results.size() == request().links_to_add.size();
    }
    void work_on_next(Subscription& subscription, MonitoredItem& trigger)
    {
        const std::size_t removed = response_.remove_results.size();
        if (removed < request().links_to_remove.size()) {
            response_.remove_results.push_back(
                remove_link(subscription, trigger, request().links_to_remove[removed]));
            return;
        }
        const std::uint32_t id = request().links_to_add[response_.add_results.size()];
        response_.add_results.push_back(add_link(
            subscription, trigger, id, all_.needs().limits.subscriptions.max_triggering_links));
    }

    SubscriptionTable& all_;
    SetTriggeringResponse response_;
};

} // namespace

std::unique_ptr<ServiceOperation> make_create_monitored_items(SubscriptionTable& all)
{
    return std::make_unique<CreateItems>(all);
}

std::unique_ptr<ServiceOperation> make_modify_monitored_items(SubscriptionTable& all)
{
    return std::make_unique<ModifyItems>(all);
}

std::unique_ptr<ServiceOperation> make_set_monitoring_mode(SubscriptionTable& all)
{
    return std::make_unique<SetItemsMode>(all);
}

std::unique_ptr<ServiceOperation> make_delete_monitored_items(SubscriptionTable& all)
{
    return std::make_unique<DeleteItems>(all);
}

std::unique_ptr<ServiceOperation> make_set_triggering(SubscriptionTable& all)
{
    return std::make_unique<SetTriggering>(all);
}

} // namespace busbar::server::detail
