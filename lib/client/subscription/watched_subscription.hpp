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

/// The first pause after a failure, and the shortest between two Subscriptions made one for the
/// other.
inline constexpr Duration first_retry = std::chrono::seconds{1};

enum class Phase : std::uint8_t {
    Wished,       // to be created
    Creating,     // CreateSubscription is under way
    Transferring, // lives at the server, in another session
    Live,
    Polling, // the server has no Subscriptions
};

/// Links of one triggering item: those that are wished and those the server knows.
struct Links {
    std::vector<ItemHandle> wished;
    std::vector<ItemHandle> made;
    /// Those whose removal has not been answered: the server may have them.
    std::vector<ItemHandle> stray;
};

/// What is still to be done at the server, in the order it is done. A handle may stand here though
/// its item is gone or needs nothing any more.
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

/// How values that lie in a Gap are had again.
struct Refresh {
    void interrupt();
    [[nodiscard]] bool is_reading() const;

    std::uint32_t losses{0}; // how often notifications were lost
    bool is_due{false};      // since the last of them nothing was asked for
    bool is_under_way{false};
    std::uint32_t failures{0};
    TimePoint at{}; // nothing is asked for before
    Operation read;
    std::array<std::deque<ItemHandle>, ItemWork::timestamps_count> to_read; // by TimestampsToReturn
};

using ItemStatuses = std::vector<std::pair<ItemHandle, ItemStatus>>;

/// A Subscription that the user wants, and what has become of it.
struct WatchedSubscription {
    WatchedSubscription(SubscriptionHandle name, SubscriptionSettings wished,
                        SubscriptionHandlers told, std::size_t max_missing);

    /// While there is a session.
    [[nodiscard]] DeliveryMode mode() const;
    /// When it needs something at the server, whatever is after `handled_until`.
    [[nodiscard]] TimePoint next_deadline(TimePoint handled_until) const;
    /// Nothing is asked for before a pause, which grows with each failure.
    void try_later(TimePoint now);
    /// Notifications are lost; the Gap ends with the next one, and then values are had again.
    void lose(StatusCode reason);

    /// It is no longer at the server: all that was under way there is void.
    void begin_anew();
    /// The session ended: requests under way have no answers. Changes of items are made again, they
    /// are the same twice.
    void interrupt(ItemTable& table);
    /// Queues all items to be made, and all links.
    void queue_all_items(ItemTable& table);
    /// Queues one, if it is still there.
    void queue_creation(ItemTable& table, ItemHandle item);

    // These call a handler, which may remove it.
    /// Tells of what was lost until `until`, if something was.
    void report_gap(DateTime until);
    void report_status(StatusCode status, const CreateSubscriptionResponse& response);
    void report_items(ItemTable& table, const ItemStatuses& statuses) const;

    SubscriptionHandle handle;
    SubscriptionSettings settings;
    /// Shared with a call under way, which may remove the Subscription.
    std::shared_ptr<const SubscriptionHandlers> handlers;

    Phase phase{Phase::Wished};
    std::uint32_t server_id{0};
    /// Counts the Subscriptions made at servers; answers for earlier ones are not heeded.
    std::uint32_t incarnation{0};
    /// A request that changes it or its items is under way. One at a time.
    bool is_busy{false};
    bool is_modified{false};
    bool is_publishing{false};
    /// The server may have made items that nobody knows the ids of.
    bool is_uncertain{false};
    std::uint32_t failures{0};
    TimePoint retry_at{};   // nothing is asked for before
    TimePoint created_at{}; // or asked for

    std::vector<ItemHandle> items; // and removed ones, until there are too many of those
    std::size_t removed_items{0};
    ItemWork work;
    std::vector<ItemHandle> under_way; // what a request that makes items is about
    /// Queues the change that is under way again.
    std::function<void(WatchedSubscription&)> redo;
    std::map<ItemHandle, Links> links;

    MessageStream messages;
    Refresh refresh;

    std::map<PollKey, PollGroup> polls;
};

} // namespace busbar::client::detail
