#pragma once

#include <map>
#include <unordered_map>
#include <utility>

#include <busbar/client/attributes.hpp>
#include <busbar/types/attribute.hpp>

#include "watched_subscription.hpp"

namespace busbar::client::detail {

/// What Subscriptions does. Everything that may call a handler is done in handle_deadline() or in
/// the answer to a request; wishes only leave work behind. A handler may make and remove whatever
/// it likes: after one was called, a WatchedSubscription has to be looked up again.
class SubscriptionEngine {
public:
    SubscriptionEngine(Requester& requester, const SubscriberLimits& limits);
    ~SubscriptionEngine();
    SubscriptionEngine(const SubscriptionEngine&) = delete;
    SubscriptionEngine& operator=(const SubscriptionEngine&) = delete;

    // Wishes (wishes.cpp).
    Result<SubscriptionHandle> create(const SubscriptionSettings& settings,
                                      SubscriptionHandlers handlers);
    Result<void> modify(SubscriptionHandle handle, const SubscriptionSettings& settings);
    Result<void> remove(SubscriptionHandle handle);
    Result<std::vector<ItemHandle>> add_items(SubscriptionHandle handle,
                                              std::vector<ItemSettings> items);
    Result<void> modify_items(std::span<const ItemHandle> items, const ItemSettings& settings);
    Result<void> remove_items(std::span<const ItemHandle> items);
    Result<void> set_triggering(ItemHandle trigger, std::vector<ItemHandle> links);
    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle);
    [[nodiscard]] bool has_session() const { return has_session_; }

    // The session (session_life.cpp).
    void session_started(bool is_new);
    void session_lost();
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);

private:
    /// Items in one request, where neither the user nor the server wants fewer.
    static constexpr std::size_t default_batch = 1'000;
    static constexpr Duration pause_after_failure = std::chrono::seconds{1};

    struct Publish {
        std::uint64_t token{0}; // of its request
        /// The server was silent for so long that it may have forgotten it; its answer counts.
        bool is_overdue{false};
        Array<SubscriptionAcknowledgement> acknowledgements;
    };
    using ItemStatuses = std::vector<std::pair<ItemHandle, ItemStatus>>;

    // Requests. `handle` gets the Result; not after session_lost() or the end of the engine.
    template <typename Response, typename Request, typename Handle>
    std::uint64_t send(Request request, Handle handle, Duration timeout = {});
    void cancel(std::uint64_t token);
    void cancel_all();
    /// The Subscription that an answer is for, unless it was made anew since.
    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle, std::uint32_t incarnation);
    template <typename F>
    void for_each(F f);

    // Work at the server (subscription_work.cpp).
    void work();
    void work_on(WatchedSubscription& subscription);
    void work_on_live(WatchedSubscription& subscription);
    void create_at_server(WatchedSubscription& subscription);
    void created(SubscriptionHandle handle, const Result<CreateSubscriptionResponse>& response);
    void creation_failed(WatchedSubscription& subscription, StatusCode status);
    void modify_at_server(WatchedSubscription& subscription);
    void set_publishing(WatchedSubscription& subscription, bool is_enabled);
    void revise(WatchedSubscription& subscription, const CreateSubscriptionResponse& revised);
    void delete_doomed();
    void doom(std::uint32_t server_id);
    /// The server has it no longer, or nobody knows what it has: it is made anew.
    void lost(WatchedSubscription& subscription, StatusCode reason, bool may_live);
    void report_status(WatchedSubscription& subscription, StatusCode status,
                       const CreateSubscriptionResponse& response);
    void try_later(WatchedSubscription& subscription);

    // Items at the server (item_creation.cpp, item_changes.cpp, item_links.cpp).
    [[nodiscard]] std::size_t batch_limit() const;
    void queue_creation(WatchedSubscription& subscription, ItemHandle handle);
    void queue_all_items(WatchedSubscription& subscription);
    bool create_items(WatchedSubscription& subscription);
    void resolve_items(WatchedSubscription& subscription, std::vector<ItemHandle> items);
    /// `done` gets the NodeIds: at once, or later if paths have to be looked up, unless the session
    /// or the Subscription at the server is another one then.
    void resolve_nodes(const WatchedSubscription& subscription, std::vector<NodeAddress> addresses,
                       std::function<void(const std::vector<Result<NodeId>>&)> done);
    /// False as soon as answers for what the Subscription is now are of no use. Outlives the
    /// engine.
    [[nodiscard]] std::function<bool()> guard(const WatchedSubscription& subscription) const;
    void items_resolved(SubscriptionHandle handle, const std::vector<Result<NodeId>>& nodes);
    void send_creation(WatchedSubscription& subscription,
                       Array<MonitoredItemCreateRequest> requests, TimestampsToReturn timestamps);
    void items_created(WatchedSubscription& subscription,
                       const Result<CreateMonitoredItemsResponse>& response);
    void item_creation_failed(WatchedSubscription& subscription, StatusCode status);
    ItemStatus item_created(WatchedSubscription& subscription, ItemHandle handle,
                            const MonitoredItemCreateResult& result);
    bool modify_items(WatchedSubscription& subscription);
    void send_modification(WatchedSubscription& subscription, ModifyMonitoredItemsRequest request,
                           std::vector<ItemHandle> batch);
    bool set_modes(WatchedSubscription& subscription);
    void send_modes(WatchedSubscription& subscription, SetMonitoringModeRequest request,
                    std::vector<ItemHandle> batch);
    bool delete_items(WatchedSubscription& subscription);
    bool link_items(WatchedSubscription& subscription);
    /// Takes the changes of `links` as made. True if there are more than one call may have.
    bool choose_links(Links& links, SetTriggeringRequest& request);
    void send_links(WatchedSubscription& subscription, SetTriggeringRequest request,
                    ItemHandle trigger);
    /// Sends a change of `count` items. If it fails, `redo` queues it again, or `done` gets the
    /// error when that has been tried often enough; `done` gets any other answer as well.
    template <typename Response, typename Request, typename Done>
    void change(WatchedSubscription& subscription, Request request, std::size_t count,
                std::function<void(WatchedSubscription&)> redo, Done done);
    /// True if a change of `count` items that failed is to be queued again; no handler was called
    /// then.
    bool change_failed(WatchedSubscription& subscription, StatusCode status, std::size_t count);
    void report_items(WatchedSubscription& subscription, const ItemStatuses& statuses);

    // Notifications (publish.cpp, delivery.cpp, republish.cpp).
    [[nodiscard]] std::size_t wanted_publishes() const;
    [[nodiscard]] std::size_t awaited_publishes() const;
    [[nodiscard]] Duration publish_timeout() const;
    void publish();
    void send_publish();
    void published(std::uint64_t token, Result<PublishResponse> response);
    void publish_failed(StatusCode status);
    void take_back(Array<SubscriptionAcknowledgement> acknowledgements);
    void forget_acknowledgements(std::uint32_t server_id);
    void acknowledge(std::uint32_t server_id, std::uint32_t sequence_number);
    void renew_publishes();
    void catch_up(WatchedSubscription& subscription);
    void receive(PublishResponse response);
    void heard(WatchedSubscription& subscription, DateTime time);
    void accept(SubscriptionHandle handle, NotificationMessage message);
    void jump_to(SubscriptionHandle handle, std::uint32_t sequence_number);
    void deliver_kept(SubscriptionHandle handle);
    void deliver(WatchedSubscription& subscription, const NotificationMessage& message);
    void deliver_data(SubscriptionHandle handle, const DataChangeNotification& notification);
    void deliver_events(SubscriptionHandle handle, const EventNotificationList& notification);
    void lose(WatchedSubscription& subscription, StatusCode reason);
    void report_gap(WatchedSubscription& subscription, DateTime until);
    void settle(SubscriptionHandle handle);
    void fetch_missing(WatchedSubscription& subscription);
    void republished(WatchedSubscription& subscription, std::uint32_t number, bool is_sent,
                     const Result<RepublishResponse>& response);
    void not_republished(WatchedSubscription& subscription, bool is_sent, StatusCode status);
    void watch(WatchedSubscription& subscription, TimePoint now);

    // Values of data items after a Gap (refresh.cpp).
    void refresh(WatchedSubscription& subscription);
    void ask_again(WatchedSubscription& subscription);
    [[nodiscard]] bool is_stale(const WatchedSubscription& subscription, ItemHandle handle);
    void call_resend_data(WatchedSubscription& subscription);
    void resend_answered(WatchedSubscription& subscription, StatusCode status);
    void queue_stale_items(WatchedSubscription& subscription);
    void read_again(WatchedSubscription& subscription);
    void read_again(WatchedSubscription& subscription, const std::vector<ItemHandle>& items,
                    const std::vector<Result<NodeId>>& nodes, const ReadSettings& settings);
    void deliver_read(SubscriptionHandle handle, const std::vector<DataChange>& values,
                      std::uint32_t losses);

    // After another session was made (session_life.cpp).
    void begin_session();
    [[nodiscard]] TimePoint deadline_of(const WatchedSubscription& subscription) const;
    void start_again(WatchedSubscription& subscription, bool is_new_session);
    void interrupt(WatchedSubscription& subscription);
    void transfer();
    void transferred(const std::vector<SubscriptionHandle>& handles,
                     const Result<TransferSubscriptionsResponse>& response);
    void transferred(WatchedSubscription& subscription, const TransferResult& result);

    // Polling (polling.cpp).
    void start_polling(WatchedSubscription& subscription);
    ItemStatus start_polling(WatchedSubscription& subscription, ItemHandle handle,
                             const NodeId& node);
    void poll(WatchedSubscription& subscription, TimePoint now);
    void read(WatchedSubscription& subscription, const PollKey& key);
    void values_read(WatchedSubscription& subscription, const PollKey& key,
                     const std::vector<std::size_t>& places, const Result<ReadResponse>& response);
    /// Keeps what was read; those values that are to be delivered.
    [[nodiscard]] std::vector<DataChange> changes_in(PollGroup& group,
                                                     const std::vector<std::size_t>& places,
                                                     const ReadResponse& response);

    Requester& requester_;
    SubscriberLimits limits_;
    ItemTable items_;
    std::map<SubscriptionHandle, WatchedSubscription> subscriptions_;
    std::unordered_map<std::uint32_t, SubscriptionHandle> by_server_id_;
    SubscriptionHandle last_handle_{0};

    bool has_session_{false};
    bool is_new_session_{false};
    bool is_begun_{false}; // what a new session needs was sent
    bool has_work_{false};
    TimePoint handled_until_{};
    std::uint64_t epoch_{0}; // counts sessions lost
    /// Tells the answers of resolve() whether the engine, and not just its requests, is still
    /// there.
    std::shared_ptr<SubscriptionEngine*> self_;
    std::uint64_t last_token_{0};
    std::unordered_map<std::uint64_t, RequestId> requests_;

    std::map<std::uint64_t, Publish> publishes_;
    std::uint64_t last_publish_{0};
    std::deque<SubscriptionAcknowledgement> acknowledgements_;
    std::size_t max_publishes_;
    TimePoint publish_at_{};
    bool has_resend_data_{true}; // the server, as far as is known

    std::size_t max_batch_;
    std::vector<std::uint32_t> doomed_; // Subscriptions to be deleted
    std::vector<std::uint32_t> deleting_;
};

template <typename Response, typename Request, typename Handle>
std::uint64_t SubscriptionEngine::send(Request request, Handle handle, Duration timeout)
{
    const std::uint64_t token = ++last_token_;
    const RequestId id = requester_.call<Response>(
        std::move(request),
        [this, token, handle = std::move(handle)](Result<Response> response) {
            requests_.erase(token);
            handle(std::move(response));
            work();
        },
        {timeout, false});
    requests_.emplace(token, id);
    return token;
}

template <typename Response, typename Request, typename Done>
void SubscriptionEngine::change(WatchedSubscription& subscription, Request request,
                                std::size_t count, std::function<void(WatchedSubscription&)> redo,
                                Done done)
{
    subscription.is_busy = true;
    subscription.redo = std::move(redo);
    send<Response>(std::move(request),
                   [this, count, done = std::move(done), handle = subscription.handle,
                    incarnation = subscription.incarnation](const Result<Response>& response) {
                       WatchedSubscription* changed = find(handle, incarnation);
                       if (changed == nullptr) {
                           return;
                       }
                       changed->is_busy = false;
                       const auto again = std::exchange(changed->redo, {});
                       if (!response && change_failed(*changed, response.error(), count)) {
                           again(*changed);
                       } else if (find(handle, incarnation) != nullptr) {
                           done(*changed, response);
                       }
                   });
}

/// A handler may remove any Subscription while `f` has another.
template <typename F>
void SubscriptionEngine::for_each(F f)
{
    for (auto next = subscriptions_.begin(); next != subscriptions_.end();) {
        const SubscriptionHandle handle = next->first;
        f(next->second);
        next = subscriptions_.upper_bound(handle);
    }
}

} // namespace busbar::client::detail
