#include <algorithm>
#include <iterator>

#include "item_changes.hpp"

namespace busbar::client::detail {

namespace {

// Adds a handle to the handles of a link, in ascending order, each once.

void put(std::vector<ItemHandle>& handles, ItemHandle handle)
{
    const auto place = std::lower_bound(handles.begin(), handles.end(), handle);
    if (place == handles.end() || *place != handle) {
        handles.insert(place, handle);
    }
}

void take_out(std::vector<ItemHandle>& handles, ItemHandle handle)
{
    const auto place = std::lower_bound(handles.begin(), handles.end(), handle);
    if (place != handles.end() && *place == handle) {
        handles.erase(place);
    }
}

} // namespace

bool ItemChanges::link(WatchedSubscription& subscription)
{
    auto& queue = subscription.work.to_link;
    while (!queue.empty()) {
        const ItemHandle trigger = queue.front();
        queue.pop_front();
        const Item* item = items_.find(trigger);
        const auto links = subscription.links.find(trigger);
        if (item == nullptr || !item->is_created || links == subscription.links.end()) {
            continue;
        }
        SetTriggeringRequest request;
        request.subscription_id = subscription.server_id;
        request.triggering_item_id = item->server_id;
        std::vector<ItemHandle> removed;
        if (choose_links(links->second, request, removed)) {
            queue.push_front(trigger);
        }
        if (!request.links_to_add.empty() || !request.links_to_remove.empty()) {
            send_links(subscription, std::move(request), trigger, std::move(removed));
            return true;
        }
    }
    return false;
}

bool ItemChanges::choose_links(Links& links, SetTriggeringRequest& request,
                               std::vector<ItemHandle>& removed)
{
    std::vector<ItemHandle> there;
    std::set_union(links.made.begin(), links.made.end(), links.stray.begin(), links.stray.end(),
                   std::back_inserter(there));
    std::vector<ItemHandle> changed;
    std::set_difference(there.begin(), there.end(), links.wished.begin(), links.wished.end(),
                        std::back_inserter(changed));
    const std::size_t removed_count = changed.size();
    std::set_difference(links.wished.begin(), links.wished.end(), links.made.begin(),
                        links.made.end(), std::back_inserter(changed));
    std::size_t count = 0;
    for (std::size_t i = 0; i < changed.size(); ++i) {
        const Item* item = items_.find(changed[i]);
        const bool is_removed = i < removed_count;
        if (item == nullptr || !item->is_created) {
            continue;
        }
        if (count == requests_.batch_limit()) {
            return true;
        }
        ++count;
        (is_removed ? request.links_to_remove : request.links_to_add).push_back(item->server_id);
        if (is_removed) {
            removed.push_back(changed[i]);
            put(links.stray, changed[i]);
            take_out(links.made, changed[i]);
        } else {
            put(links.made, changed[i]);
        }
    }
    return false;
}

void ItemChanges::send_links(WatchedSubscription& subscription, SetTriggeringRequest request,
                             ItemHandle trigger, std::vector<ItemHandle> removed)
{
    const std::size_t count = request.links_to_add.size() + request.links_to_remove.size();
    const auto redo = [trigger](WatchedSubscription& changed) {
        const auto links = changed.links.find(trigger);
        if (links != changed.links.end()) {
            links->second.made.clear(); // adding an existing link does no harm
            changed.work.to_link.push_back(trigger);
        }
    };
    requests_.change<SetTriggeringResponse>(
        subscription, std::move(request), count, redo,
        [this, trigger, removed = std::move(removed)](WatchedSubscription& changed,
                                                      const auto& response) {
            if (!response) {
                changed.report_items(items_, {{trigger, {response.error(), 0, 0, {}}}});
                return;
            }
            if (const auto links = changed.links.find(trigger); links != changed.links.end()) {
                for (const ItemHandle gone : removed) {
                    take_out(links->second.stray, gone);
                }
            }
            const auto& results = response->add_results;
            const auto bad = std::find_if(results.begin(), results.end(),
                                          [](StatusCode result) { return result.is_bad(); });
            if (bad != results.end()) {
                changed.report_items(items_, {{trigger, {*bad, 0, 0, {}}}});
            }
        });
}

} // namespace busbar::client::detail
