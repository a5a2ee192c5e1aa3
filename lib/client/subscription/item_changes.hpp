#pragma once

#include <vector>

#include "item_requests.hpp"
#include "item_table.hpp"

namespace busbar::client::detail {

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
