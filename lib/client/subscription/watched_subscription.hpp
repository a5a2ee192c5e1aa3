#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/client/operation.hpp>

#include "item_poll.hpp"
#include "item_table.hpp"
#include "message_stream.hpp"

namespace busbar::client::detail {

/// The first pause after a failure, and the shortest between two Subscriptions that replace each
/// other.
inline constexpr Duration first_retry = std::chrono::seconds{1};

enum class Phase : std::uint8_t {
    Wished,       // to be created
    Creating,     // CreateSubscription is under way
    Transferring, // exists at the server, in another session
    Live,
    Polling, // the server has no Subscriptions
};

/// Links of one triggering item: the requested ones and those that the server knows.
struct Links {
    std::vector<ItemHandle> wished;
    std::vector<ItemHandle> made;
    /// Links whose removal has not been answered: the server may have them.
    std::vector<ItemHandle> stray;
};

/// Pending work at the server, in the order of execution. A handle may be here although its item is
/// removed or needs nothing any more.
struct ItemWork {
    static constexpr std::size_t timestamps_count = 4;

    [[nodiscard]] bool is_creation_done() const;
    void clear();

    std::array<std::deque<ItemHandle>, timestamps_count> to_create; // by TimestampsToReturn
    std::array<std::deque<ItemHandle>, timestamps_count> to_modify;
    std::array<std::deque<ItemHandle>, 3> to_set_mode; // by MonitoringMode
    std::deque<std::uint32_t> to_delete;               // the server's ids
    std::deque<ItemHandle> to_link;
};

/// Recovers the values within a Gap.
struct Refresh {
    void interrupt();
    [[nodiscard]] bool is_reading() const;

    std::uint32_t losses{0}; // number of losses of notifications
    bool is_due{false};      // since the last of them nothing was requested
    bool is_under_way{false};
    std::uint32_t failures{0};
    TimePoint at{}; // nothing is requested before
    Operation read;
    std::array<std::deque<ItemHandle>, ItemWork::timestamps_count> to_read; // by TimestampsToReturn
};

using ItemStatuses = std::vector<std::pair<ItemHandle, ItemStatus>>;

/// A Subscription that the user wants, and its state.
struct WatchedSubscription {
    WatchedSubscription(SubscriptionHandle name, SubscriptionSettings wished,
                        SubscriptionHandlers told, std::size_t max_missing);

    /// While there is a session.
    [[nodiscard]] DeliveryMode mode() const;
    /// The time when it needs something at the server, later than `handled_until`.
    [[nodiscard]] TimePoint next_deadline(TimePoint handled_until) const;
    /// Nothing is requested before a pause, which grows with each failure.
    void try_later(TimePoint now);
    /// Notifications are lost; the Gap ends with the next one, and then values are recovered.
    void lose(StatusCode reason);

    /// It does not exist at the server any more: all its pending requests are void.
    void begin_anew();
    /// The session ended: pending requests will not be answered. Changes of items are made again,
    /// which does no harm.
    void interrupt(ItemTable& table);
    /// Queues all items and all links for creation.
    void queue_all_items(ItemTable& table);
    /// Queues one item, if it still exists.
    void queue_creation(ItemTable& table, ItemHandle item);

    // These call a handler, which may remove it.
    /// Reports what was lost until `until`, if something was.
    void report_gap(DateTime until);
    void report_status(StatusCode status, const CreateSubscriptionResponse& response);
    void report_items(ItemTable& table, const ItemStatuses& statuses) const;

    SubscriptionHandle handle;
    SubscriptionSettings settings;
    /// Shared with a running call, which may remove the Subscription.
    std::shared_ptr<const SubscriptionHandlers> handlers;

    Phase phase{Phase::Wished};
    std::uint32_t server_id{0};
    /// Counts the Subscriptions created at servers; answers for earlier ones are ignored.
    std::uint32_t incarnation{0};
    /// A request that changes it or its items is under way. One at a time.
    bool is_busy{false};
    bool is_modified{false};
    bool is_publishing{false};
    /// The server may have created items whose ids are unknown.
    bool is_uncertain{false};
    std::uint32_t failures{0};
    TimePoint retry_at{};   // nothing is requested before
    TimePoint created_at{}; // or requested

    std::vector<ItemHandle> items; // including removed ones, until there are too many of these
    std::size_t removed_items{0};
    ItemWork work;
    std::vector<ItemHandle> under_way; // items of a pending creation request
    /// Queues the pending change again.
    std::function<void(WatchedSubscription&)> redo;
    std::map<ItemHandle, Links> links;

    MessageStream messages;
    Refresh refresh;

    std::map<PollKey, PollGroup> polls;
};

} // namespace busbar::client::detail
