#pragma once

#include <vector>

#include "item_requests.hpp"
#include "item_table.hpp"
#include "polling.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Creates items at the server (Part 4, 5.13.2), or adds them to the polled ones.
class ItemCreation {
public:
    ItemCreation(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
                 SubscriptionEnds& ends, ItemRequests& changes, ItemPolling& polling);

    /// Starts with the next queued batch. False if there is none.
    bool create(WatchedSubscription& subscription);

private:
    void resolve_items(WatchedSubscription& subscription, std::vector<ItemHandle> items);
    void items_resolved(SubscriptionHandle handle, std::vector<Result<NodeId>> nodes);
    void send_creation(WatchedSubscription& subscription,
                       Array<MonitoredItemCreateRequest> requests, TimestampsToReturn timestamps);
    void items_created(WatchedSubscription& subscription,
                       const Result<CreateMonitoredItemsResponse>& response);
    void item_creation_failed(WatchedSubscription& subscription, StatusCode status);
    ItemStatus item_created(WatchedSubscription& subscription, ItemHandle handle,
                            const MonitoredItemCreateResult& result);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    ItemRequests& changes_;
    ItemPolling& polling_;
};

/// Changes items at the server: parameters, MonitoringModes, links and their end (Part 4, 5.13.3 to
/// 5.13.6).
class ItemChanges {
public:
    ItemChanges(ItemTable& items, ItemRequests& requests);

    /// Each of these sends the next request that is needed. False if none is.
    bool send_one(WatchedSubscription& subscription);
    bool remove(WatchedSubscription& subscription);

private:
    bool modify(WatchedSubscription& subscription);
    void send_modification(WatchedSubscription& subscription, ModifyMonitoredItemsRequest request,
                           const std::vector<ItemHandle>& batch);
    bool set_modes(WatchedSubscription& subscription);
    void send_modes(WatchedSubscription& subscription, SetMonitoringModeRequest request,
                    const std::vector<ItemHandle>& batch);
    bool link(WatchedSubscription& subscription);
    /// Takes the changes of `links` as made. True if there are more than one call may have.
    bool choose_links(Links& links, SetTriggeringRequest& request,
                      std::vector<ItemHandle>& removed);
    void send_links(WatchedSubscription& subscription, SetTriggeringRequest request,
                    ItemHandle trigger, std::vector<ItemHandle> removed);

    ItemTable& items_;
    ItemRequests& requests_;
};

} // namespace busbar::client::detail
