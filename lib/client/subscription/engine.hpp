#pragma once

#include <span>
#include <vector>

#include "item_changes.hpp"
#include "item_requests.hpp"
#include "item_table.hpp"
#include "polling.hpp"
#include "publish_queue.hpp"
#include "publishing.hpp"
#include "reception.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "subscription_setup.hpp"
#include "value_refresh.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// The user's requests, as in busbar/client/subscriptions.hpp. They send nothing and call no
/// handler, but queue work.
class Wishes {
public:
    Wishes(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
           SubscriptionEnds& ends, const SubscriberLimits& limits);

    Result<SubscriptionHandle> create(const SubscriptionSettings& settings,
                                      SubscriptionHandlers handlers);
    Result<void> modify(SubscriptionHandle handle, const SubscriptionSettings& settings);
    Result<void> remove(SubscriptionHandle handle);
    Result<std::vector<ItemHandle>> add_items(SubscriptionHandle handle,
                                              std::vector<ItemSettings> items);
    Result<void> modify_items(std::span<const ItemHandle> items, const ItemSettings& settings);
    Result<void> remove_items(std::span<const ItemHandle> items);
    Result<void> set_triggering(ItemHandle trigger, std::vector<ItemHandle> links);

private:
    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    SubscriberLimits limits_;
};

/// The parts of Subscriptions and their order. Each part owns the state that is named with it and
/// knows only the parts before it. Everything that may call a handler is done in handle_deadline()
/// or in the answer to a request.
class SubscriptionEngine {
public:
    SubscriptionEngine(Requester& requester, const SubscriberLimits& limits);
    SubscriptionEngine(const SubscriptionEngine&) = delete;
    SubscriptionEngine& operator=(const SubscriptionEngine&) = delete;

    [[nodiscard]] Wishes& wishes() { return wishes_; }
    /// Returns null if the user has no such Subscription.
    [[nodiscard]] const WatchedSubscription* find(SubscriptionHandle handle);
    [[nodiscard]] bool has_session() const { return requests_.has_session(); }

    void session_started(bool is_new);
    void session_lost();
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);

private:
    void begin_session();
    void start_over();
    void do_all(TimePoint now);
    void work();
    void work_on(WatchedSubscription& subscription);
    void work_on_live(WatchedSubscription& subscription);

    ItemTable items_;            // the user's items
    WatchList subscriptions_;    // the user's Subscriptions, and the progress of each
    PublishQueue publishes_;     // Publish requests under way and acknowledgements
    SessionRequests requests_;   // all requests under way, and whether there is a session
    SubscriptionEnds ends_;      // Subscriptions to be deleted at the server
    ItemRequests item_requests_; // the number of items that the server accepts in one request
    ItemPolling polling_;        // the number of items that it reads in one
    ItemCreation creation_;
    ItemChanges changes_;
    SubscriptionSetup setup_;
    Delivery delivery_;
    Reception reception_;
    Publishing publishing_; // the time until which no Publish is sent
    ValueRefresh refresh_;  // whether the server has ResendData
    SessionChange sessions_;
    Wishes wishes_;

    bool is_new_session_{false};
    bool is_begun_{false}; // the requests that a new session needs were sent
    TimePoint handled_until_{};
};

} // namespace busbar::client::detail
