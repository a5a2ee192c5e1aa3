#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include <busbar/server/access_control.hpp>
#include <busbar/server/subscription_limits.hpp>

#include "server/rights/node_rights.hpp"
#include "server/session/counters.hpp"
#include "server/users/shares.hpp"

#include "item_list.hpp"
#include "ready_list.hpp"
#include "retransmission_queue.hpp"
#include "state_table.hpp"
#include "timer_queue.hpp"

namespace busbar::server::detail {

class Session;
class PublishOperation;
class SubscriptionTable;

/// The parameters of a Subscription, as revised (Part 4, 5.14.2.2).
struct SubscriptionParameters {
    Duration publishing_interval{0};
    std::uint32_t lifetime_count{0};
    std::uint32_t max_keep_alive_count{0};
    /// 0 if only the server's limit applies.
    std::uint32_t max_notifications_per_publish{0};
    std::uint8_t priority{0};
};

/// Limits the requested values to their ranges, including NaN intervals, counts of 0 and products
/// that would overflow.
[[nodiscard]] SubscriptionParameters
revise(const SubscriptionLimits& limits, double publishing_interval, std::uint32_t lifetime_count,
       std::uint32_t max_keep_alive_count, std::uint32_t max_notifications_per_publish,
       std::uint8_t priority);

/// The owner of a Subscription, which it keeps when its session ends.
struct SubscriptionOwner {
    UserIdentity user;
    std::string address;
    std::string application_uri;
    bool is_signed{false};
    bool is_encrypted{false};
    std::vector<std::string> locale_ids;
};

/// A Subscription (Part 4, 5.14.1): its items, its state and its sent messages.
///
/// Everything that happens to it is an event for the state table; handle() performs the table's
/// row. Belongs to the table of Subscriptions, which removes it when its state is Closed.
class Subscription final : public Timer {
public:
    using State = SubscriptionState;

    Subscription(SubscriptionTable& all, std::uint32_t id, Session& session);
    Subscription(const Subscription&) = delete;
    Subscription& operator=(const Subscription&) = delete;
    ~Subscription() override;

    [[nodiscard]] std::uint32_t id() const { return id_; }
    [[nodiscard]] State state() const { return state_; }
    [[nodiscard]] const SubscriptionParameters& parameters() const { return parameters_; }
    [[nodiscard]] bool publishing_enabled() const { return publishing_enabled_; }

    // Events.

    /// The data that a service passes to the row's actions.
    struct Input {
        TimePoint now{};
        const SubscriptionParameters* parameters{nullptr};
        bool publishing_enabled{false};
        /// Republish.
        bool is_message_found{false};
        /// TransferSubscriptions and DeleteSubscriptions: the requesting session.
        Session* session{nullptr};
        bool is_client_validated{false};
    };
    /// Performs the table's row for the event, and returns it.
    const SubscriptionRow& handle(SubscriptionEvent event, const Input& input);
    /// The publishing timer.
    void expire(TimePoint now) override;
    [[nodiscard]] unsigned rank() const override { return parameters_.priority; }

    // Sessions.

    /// Null after the session has ended, until another one takes over.
    [[nodiscard]] Session* session() const { return session_; }
    [[nodiscard]] SubscriptionOwner owner() const;
    [[nodiscard]] const UserIdentity& user() const;
    /// Returns the rights of its user over its channel; valid until either changes.
    [[nodiscard]] NodeRights rights() const;
    /// Returns whether the channel of its session is encrypted, or was last.
    [[nodiscard]] bool is_encrypted() const;
    /// Returns its client's locales in order of preference.
    [[nodiscard]] std::span<const std::string> locales() const;
    /// The session ends; the Subscription continues, for `owner`, until its lifetime is over.
    void detach(std::unique_ptr<SubscriptionOwner> owner);
    /// Its session has another user or comes from another address.
    void update_share();
    /// The share of its user, including itself.
    [[nodiscard]] const Share& share() const { return *share_; }
    [[nodiscard]] Share& share() { return *share_; }
    /// Increases with each Subscription that was created, or lost its session.
    [[nodiscard]] std::uint64_t since() const { return since_; }
    /// Ends its lifetime at once, to make room for another one: State is Closed then.
    void give_way(TimePoint now);
    /// It is deleted: changes of its items are not reported any more.
    void end();
    /// The Subscription has the rights of another user from now on. Its items must be reviewed.
    void note_user_change() noexcept;
    /// The last value of each data item that reports and has an empty queue is to be queued, before
    /// anything else is published. Its items must be reviewed.
    void note_resend() noexcept;
    /// Looks at up to `room` items, more than 0, that must be reviewed, and takes their number from
    /// `room`. See ItemReviews.
    void review(TimePoint now, std::size_t& room);
    [[nodiscard]] bool is_in_review() const { return review_.is_pending; }
    /// Any service that names the Subscription proves that its client is alive.
    void reset_lifetime_counter() { lifetime_counter_ = parameters_.lifetime_count; }

    // Publishing.

    /// True if the next Publish request is answered at once.
    [[nodiscard]] bool wants_publish_request() const;
    /// Increases with each sent message; the one served longest ago comes first.
    [[nodiscard]] std::uint64_t last_served() const { return last_served_; }
    [[nodiscard]] RetransmissionQueue& retransmission() { return retransmission_; }
    [[nodiscard]] const RetransmissionQueue& retransmission() const { return retransmission_; }
    /// The sequence number of the next message (Part 4, 7.8).
    [[nodiscard]] std::uint32_t next_sequence_number() const;

    // Diagnostics.

    [[nodiscard]] const SubscriptionCounters& counters() const { return counters_; }
    void count(std::uint32_t SubscriptionDiagnosticsDataType::*counter, std::uint32_t more = 1);
    [[nodiscard]] std::uint32_t lifetime_counter() const { return lifetime_counter_; }

    // Items.

    [[nodiscard]] SubscriptionTable& all() const { return all_; }
    [[nodiscard]] std::size_t disabled_item_count() const { return disabled_item_count_; }
    void count_disabled(std::ptrdiff_t more)
    {
        disabled_item_count_ += static_cast<std::size_t>(more);
    }
    [[nodiscard]] std::size_t item_count() const { return items_.size(); }
    [[nodiscard]] MonitoredItem* find_item(std::uint32_t id) const { return items_.find(id); }
    MonitoredItem& add_item(std::unique_ptr<MonitoredItem> item);
    /// Returns false if there is no such item. Removing an item needs no memory.
    [[nodiscard]] bool remove_item(std::uint32_t id) noexcept;
    /// Removes at most this many items; returns their number.
    std::size_t remove_items(std::size_t most) noexcept;
    /// In ascending order.
    [[nodiscard]] std::vector<std::uint32_t> item_ids() const;
    /// See ValueItem::announce_change. Returns false if there was no memory to look an item up
    /// again.
    bool announce_change(const std::unordered_set<NodeId>& variables, std::uint32_t status_bits);
    [[nodiscard]] ReadyList& ready(MonitoredItem::Kind kind)
    {
        return kind == MonitoredItem::Kind::Data ? ready_data_ : ready_events_;
    }
    [[nodiscard]] MemoryAccount& memory() { return memory_; }

private:
    friend class ItemReviews;

    [[nodiscard]] SubscriptionVariables variables(const Input& input) const;
    [[nodiscard]] bool notifications_available() const
    {
        return !is_in_review() && (!ready_data_.empty() || !ready_events_.empty());
    }
    void count_items(std::ptrdiff_t more) noexcept;
    void perform(SubscriptionAction action, const SubscriptionRow& row, const Input& input);
    void start_publishing_timer(TimePoint now);
    [[nodiscard]] TimePoint end_of_first_cycle(TimePoint now) const;
    void update_parameters(const SubscriptionParameters& parameters, TimePoint now);
    void set_publishing_enabled(bool is_enabled);
    void return_notifications();
    void return_keep_alive();
    void issue_status_change(StatusCode status);
    void set_session(Session& session);
    [[nodiscard]] const SubscriptionOwner& kept_owner() const;
    [[nodiscard]] ItemContext context(TimePoint now) { return {all_, *this, now}; }

    /// The items from `next_id` on have not been told this yet.
    struct Review {
        bool is_pending{false};
        bool has_other_user{false};
        bool resends{false};
        std::uint64_t next_id{0};
    };

    SubscriptionTable& all_;
    std::uint32_t id_;
    Session* session_;
    /// Null while there is a session.
    std::unique_ptr<SubscriptionOwner> owner_;
    /// Null after end().
    Share* share_{nullptr};
    std::uint64_t since_;
    SubscriptionParameters parameters_;

    // The state variables (Part 4, 5.14.1.3).

    State state_{State::Closed};
    bool publishing_enabled_{false};
    bool more_notifications_{false};
    /// Events had to wait for data in the last message.
    bool events_first_{false};
    bool message_sent_{false};
    std::uint32_t keep_alive_counter_{0};
    std::uint32_t lifetime_counter_{0};
    /// The number of the last message; 0 is never sent.
    std::uint32_t sequence_number_{0};

    SubscriptionCounters counters_;
    std::size_t disabled_item_count_{0};
    Review review_;
    /// Neighbours in the list of ItemReviews, which it is part of if is_listed_.
    Subscription* previous_listed_{nullptr};
    Subscription* next_listed_{nullptr};
    bool is_listed_{false};
    TimePoint next_publishing_{no_deadline};
    std::uint64_t last_served_{0};
    MemoryAccount memory_;
    RetransmissionQueue retransmission_;
    ReadyList ready_data_;
    ReadyList ready_events_;
    /// Destroyed before the lists they are in.
    ItemList items_;
};

} // namespace busbar::server::detail
