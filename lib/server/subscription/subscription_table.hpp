#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>

#include "ended_subscriptions.hpp"
#include "item_reviews.hpp"
#include "server/users/shares.hpp"
#include "subscription_needs.hpp"
#include "timer_queue.hpp"
#include "value_queue.hpp"

namespace busbar::server::detail {

struct SubscriptionParameters;
class Sampler;
class Session;
class Subscription;

/// All Subscriptions of a server, with their common timers, sampling and memory.
class SubscriptionTable {
public:
    explicit SubscriptionTable(const SubscriptionNeeds& needs);
    SubscriptionTable(const SubscriptionTable&) = delete;
    SubscriptionTable& operator=(const SubscriptionTable&) = delete;
    ~SubscriptionTable();

    /// Returns Bad_TooManySubscriptions if the session, its user or the server has the maximum and
    /// none gives way; see SubscriptionLimits.
    [[nodiscard]] Result<Subscription*> create(Session& session,
                                               const SubscriptionParameters& parameters,
                                               bool publishing_enabled, TimePoint now);
    /// Returns null if there is none.
    [[nodiscard]] Subscription* find(std::uint32_t id) const;
    /// Returns null if there is none or it belongs to another session.
    [[nodiscard]] Subscription* find(std::uint32_t id, const Session& session) const;
    /// Its items may exist for a while, invisibly: they are counted and paid for until they are
    /// deleted.
    void remove(Subscription& subscription);
    /// Deletes some items of removed Subscriptions; false if there are none.
    bool sweep_ended();
    /// Returns whether the Subscription's user, and the server, may have one more item; makes
    /// others give way if necessary.
    [[nodiscard]] bool make_room_for_item(const Subscription& subscription, TimePoint now);
    /// Returns whether the session's user may take the Subscription over.
    [[nodiscard]] bool has_share_for(const Subscription& subscription,
                                     const Session& session) const;

    /// The session ends: its Subscriptions with it if `deletes_subscriptions`, else they survive
    /// for their lifetime (Part 4, 5.6.4).
    void session_ends(Session& session, bool deletes_subscriptions);
    /// The session may have another channel, and another user.
    void session_moved(Session& session);
    /// The session has another user.
    void user_changed(Session& session, TimePoint now);
    /// See Server::announce_access_change.
    void access_changed(TimePoint now);

    /// Notifies all items of the Variables' values; see ValueItem::announce_change.
    void announce_change(const std::unordered_set<NodeId>& variables, std::uint32_t status_bits);

    [[nodiscard]] TimePoint next_deadline() const
    {
        return std::min(timers_.next_deadline(), reviews_.next_deadline());
    }
    void handle_deadline(TimePoint now);

    [[nodiscard]] const SubscriptionNeeds& needs() const { return needs_; }
    [[nodiscard]] TimerQueue& timers() { return timers_; }
    [[nodiscard]] ItemReviews& reviews() { return reviews_; }
    [[nodiscard]] Sampler& sampler() { return *sampler_; }
    [[nodiscard]] const Sampler& sampler() const { return *sampler_; }
    [[nodiscard]] MemoryAccount& memory() { return memory_; }
    [[nodiscard]] Shares& shares() { return shares_; }
    [[nodiscard]] std::size_t size() const { return subscriptions_.size(); }
    [[nodiscard]] std::size_t item_count() const { return item_count_; }
    void count_items(std::ptrdiff_t more) noexcept
    {
        item_count_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(item_count_) + more);
    }
    [[nodiscard]] std::uint64_t next_serial() { return ++serial_; }
    [[nodiscard]] const std::unordered_map<std::uint32_t, std::unique_ptr<Subscription>>&
    all() const
    {
        return subscriptions_;
    }

private:
    /// The user who needs a place, and the kind of place that is short.
    struct Want {
        const UserIdentity& user;
        std::string_view address;
        std::size_t Share::*what;
        std::string_view limit;
        TimePoint now;
    };
    [[nodiscard]] std::uint32_t new_id();
    [[nodiscard]] bool make_place(const Session& session, TimePoint now);
    /// Returns null if none must give way. With `is_own` only one of the same user.
    [[nodiscard]] Subscription* find_giving_way(const Share* taker, std::size_t Share::*what,
                                                bool is_own) const;
    /// Returns false if there was none.
    bool displace(const Want& want, bool is_own);

    const SubscriptionNeeds& needs_;
    TimerQueue timers_;
    MemoryAccount memory_;
    Shares shares_;
    std::unique_ptr<Sampler> sampler_;
    std::size_t item_count_{0};
    std::uint64_t serial_{0};
    std::uint32_t last_id_;
    EndedSubscriptions ended_;
    ItemReviews reviews_;
    std::unordered_map<std::uint32_t, std::unique_ptr<Subscription>> subscriptions_;
};

} // namespace busbar::server::detail
