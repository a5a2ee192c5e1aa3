#pragma once

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <busbar/client/operation.hpp>

#include "item_poll.hpp"
#include "item_table.hpp"
#include "sequence_tracker.hpp"

namespace busbar::client::detail {

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

/// Why notifications are missing and since when; becomes a Gap with the next notification.
struct Loss {
    StatusCode reason;
    DateTime from;
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

/// A Subscription that the user wants, and what has become of it.
struct WatchedSubscription {
    WatchedSubscription(SubscriptionHandle name, SubscriptionSettings wished,
                        SubscriptionHandlers told, std::size_t max_missing);

    /// While there is a session.
    [[nodiscard]] DeliveryMode mode() const;

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

    SequenceTracker sequence;
    bool is_republishing{false};
    /// Republish shall tell whether there is more than is known of.
    bool is_probing{false};
    /// Since the session began it was not yet brought up to date; nothing is published meanwhile.
    bool is_catching_up{false};
    std::size_t probe_count{0};
    std::uint32_t republish_failures{0};
    TimePoint republish_at{};
    Duration keep_alive_interval{0};
    TimePoint silent_at{no_deadline};
    std::uint32_t silences{0};
    DateTime heard_time;     // of the last message
    DateTime complete_until; // null before the first message
    std::optional<Loss> loss;
    Refresh refresh;

    std::map<PollKey, PollGroup> polls;
};

} // namespace busbar::client::detail
