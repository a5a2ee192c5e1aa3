#pragma once

#include <optional>

#include "event_item_queue.hpp"
#include "server/event/event_filter.hpp"
#include "server/event/events.hpp"
#include "server/subscription/monitored_item.hpp"
#include "server/subscription/subscription_needs.hpp"

namespace busbar::server::detail {

/// A MonitoredItem of a Node's EventNotifier attribute (Part 4, 5.13.1.4): queues the selected
/// fields of the events that pass its filter.
class EventItem final : public MonitoredItem, private EventReceiver {
public:
    /// `notifier` is the node whose events it gets. Good, or why the filter is refused; the item
    /// can then only be destroyed.
    EventItem(Events& events, const ItemContext& context, const MonitoredItemCreateRequest& request,
              model::NodeHandle notifier, ItemRevision& revision);
    ~EventItem() override;

    [[nodiscard]] std::size_t queued() const override
    {
        return queue_.size() + (owes_overflow_ ? 1 : 0);
    }
    [[nodiscard]] std::size_t notification_size() const override;
    void take_notification(binary::Writer& writer, std::size_t most) override;
    void modify(const ItemContext& context, const MonitoringParameters& parameters,
                TimestampsToReturn timestamps, ItemRevision& revision) override;
    void user_changed(const ItemContext& context) override;

protected:
    void clear() override
    {
        queue_.clear();
        owes_overflow_ = false;
    }
    void mode_changed(const ItemContext& context, MonitoringMode before) override;

private:
    void deliver(const RaisedEvent& event) override;
    void tell_of_loss() override;
    /// Sets filter and queue size, or neither.
    void set(const MonitoringParameters& parameters, ItemRevision& revision);
    [[nodiscard]] StatusCode take_filter(const ExtensionObject& filter, ItemRevision& revision);
    void queue_overflow();
    /// Queues the overflow event that is owed. May throw, and it is then still owed.
    void pay_overflow();
    [[nodiscard]] bool may_know_of(model::NodeIndex type) const;

    Events& events_;
    const SubscriptionNeeds& needs_;
    CompiledEventFilter filter_;
    std::size_t paid_{0};
    EventItemQueue queue_;
    bool may_receive_{true};
    /// Events were lost, and there was no memory for the overflow event.
    bool owes_overflow_{false};
};

/// Creates items for the events of one server.
class EventItemMaker final : public EventItems {
public:
    explicit EventItemMaker(Events& events) : events_{events} {}

    [[nodiscard]] std::unique_ptr<MonitoredItem> make(const ItemContext& context,
                                                      const MonitoredItemCreateRequest& request,
                                                      ItemRevision& revision) override;

private:
    Events& events_;
};

} // namespace busbar::server::detail
