#include <tuple>

#include "server/session/session.hpp"
#include "subscription.hpp"
#include "subscription_table.hpp"

// Decides which Subscription ends to make room for another one, when there are too many. The
// specification leaves that to the server: it has only Bad_TooManySubscriptions (Part 4, 5.14.2.3)
// and, for the one that ends, the StatusChangeNotification Bad_Timeout (Part 4, 5.14.1.1).

namespace busbar::server::detail {

namespace {

/// True if no client would miss it.
bool is_left(const Subscription& subscription)
{
    return subscription.session() == nullptr || subscription.session()->peer == nullptr;
}

} // namespace

Subscription* SubscriptionTable::find_giving_way(const Share* taker, std::size_t Share::*what,
                                                 bool is_own) const
{
    // Subscriptions with a session come last; then those of the user with most first, and of his
    // the oldest.
    const auto order = [what](const Subscription& s) {
        return std::tuple{s.session() != nullptr, ~(s.share().*what), s.since()};
    };
    const std::size_t had = taker == nullptr ? 0 : taker->*what;
    Subscription* first = nullptr;
    for (const auto& [id, candidate] : subscriptions_) {
        const bool is_his = &candidate->share() == taker;
        const bool may_go = is_his || (!is_own && candidate->share().*what > had);
        const bool helps = what == &Share::places || candidate->item_count() != 0;
        if (is_left(*candidate) && may_go && helps &&
            (first == nullptr || order(*candidate) < order(*first))) {
            first = candidate.get();
        }
    }
    return first;
}

bool SubscriptionTable::displace(const Want& want, bool is_own)
{
    Subscription* const found =
        find_giving_way(shares_.find(want.user, want.address), want.what, is_own);
    if (found == nullptr) {
        return false;
    }
    Share& loser = found->share();
    if (!loser.is_told) { // logged once, since there may be a thousand more
        loser.is_told = true;
        needs_.log.write(LogLevel::Warning, "subscription",
                         "Subscription " + std::to_string(found->id()) + " of " + loser.text +
                             ", whose client has gone, gives way to " + describe(want.user) +
                             " from " + std::string{want.address} + ": limit " +
                             std::string{want.limit} + ", of which " +
                             std::to_string(loser.*want.what) + " were " + loser.text +
                             "'s. Others of his may follow without a word");
    }
    found->give_way(want.now);
    remove(*found);
    return true;
}

bool SubscriptionTable::make_place(const Session& session, TimePoint now)
{
    const SubscriptionLimits& limits = needs_.limits.subscriptions;
    Want want{session.user, session.address, &Share::places, "max_subscriptions_per_user", now};
    const Share* const own = shares_.find(session.user, session.address);
    if (own != nullptr && own->places >= limits.max_subscriptions_per_user &&
        !displace(want, true)) {
        return false;
    }
    want.limit = "max_subscriptions";
    return size() < limits.max_subscriptions || displace(want, false);
}

bool SubscriptionTable::make_room_for_item(const Subscription& subscription, TimePoint now)
{
    const SubscriptionLimits& limits = needs_.limits.subscriptions;
    const Session& session = *subscription.session();
    Want want{session.user, session.address, &Share::items, "max_items_per_user", now};
    if (subscription.share().items >= limits.max_items_per_user && !displace(want, true)) {
        return false;
    }
    want.limit = "max_items";
    // Subscriptions that have ended already will make room soon.
    if (item_count_ >= limits.max_items && ended_.size() == 0) {
        displace(want, false);
    }
    return item_count_ < limits.max_items;
}

bool SubscriptionTable::has_share_for(const Subscription& subscription,
                                      const Session& session) const
{
    const SubscriptionLimits& limits = needs_.limits.subscriptions;
    const Share* const own = shares_.find(session.user, session.address);
    return own == nullptr || own == &subscription.share() ||
           (own->places < limits.max_subscriptions_per_user &&
            own->items + subscription.item_count() <= limits.max_items_per_user);
}

} // namespace busbar::server::detail
