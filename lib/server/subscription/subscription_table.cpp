#include "subscription_table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "publish_queue.hpp"
#include "sampler.hpp"
#include "server/session/session.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Ids begin at a random number, so that a client which survives a restart does not meet another
/// client's.
std::uint32_t random_id(crypto::Random& random)
{
    std::array<std::byte, 4> bytes{};
    static_cast<void>(random.fill(bytes)); // without randomness they begin at 1
    return std::bit_cast<std::uint32_t>(bytes);
}

} // namespace

SubscriptionTable::SubscriptionTable(const SubscriptionNeeds& needs)
    : needs_{needs}, memory_{needs.limits.subscriptions.max_memory, nullptr},
      sampler_{std::make_unique<Sampler>(needs, timers_, memory_)},
      last_id_{random_id(*needs.environment.random)}, ended_{timers_}, reviews_{*sampler_,
                                                                                needs.log}
{
}

SubscriptionTable::~SubscriptionTable()
{
    subscriptions_.clear();
    ended_.clear();
    sampler_->tell_sources();
}

std::uint32_t SubscriptionTable::new_id()
{
    do {
        ++last_id_;
    } while (last_id_ == 0 || subscriptions_.contains(last_id_));
    return last_id_;
}

Result<Subscription*> SubscriptionTable::create(Session& session,
                                                const SubscriptionParameters& parameters,
                                                bool publishing_enabled, TimePoint now)
{
    const SubscriptionLimits& limits = needs_.limits.subscriptions;
    PublishPart& part = PublishPart::of(session);
    // Row 2 of the state table.
    if (part.subscriptions().size() >= limits.max_subscriptions_per_session ||
        !make_place(session, now)) {
        return fail(status::Bad_TooManySubscriptions);
    }
    // Ended ones take memory, too: worst_case_memory() counts max_subscriptions of both.
    constexpr std::size_t items_at_once = 1'000;
    if (size() + ended_.size() >= limits.max_subscriptions) {
        static_cast<void>(ended_.sweep(items_at_once));
    }
    if (size() + ended_.size() >= limits.max_subscriptions) {
        return fail(status::Bad_TooManySubscriptions);
    }
    const std::uint32_t id = new_id();
    Subscription& made =
        *subscriptions_.emplace(id, std::make_unique<Subscription>(*this, id, session))
             .first->second;
    busbar::detail::Undo undo{[&] {
        if (needs_.observer != nullptr) {
            needs_.observer->removed(made);
        }
        part.remove(made);
        subscriptions_.erase(id);
    }};
    part.add(made);
    made.handle(SubscriptionEvent::CreateSubscription, {.now = now});
    made.handle(SubscriptionEvent::Created,
                {.now = now, .parameters = &parameters, .publishing_enabled = publishing_enabled});
    if (needs_.observer != nullptr) {
        needs_.observer->added(made);
    }
    undo.keep();
    ++needs_.counters.summary.cumulated_subscription_count;
    return &made;
}

Subscription* SubscriptionTable::find(std::uint32_t id) const
{
    const auto found = subscriptions_.find(id);
    return found == subscriptions_.end() ? nullptr : found->second.get();
}

Subscription* SubscriptionTable::find(std::uint32_t id, const Session& session) const
{
    Subscription* const found = find(id);
    return found != nullptr && found->session() == &session ? found : nullptr;
}

void SubscriptionTable::remove(Subscription& subscription)
{
    if (needs_.observer != nullptr) {
        needs_.observer->removed(subscription);
    }
    reviews_.remove(subscription);
    subscription.end();
    ended_.add(std::move(subscriptions_.extract(subscription.id()).mapped()));
}

bool SubscriptionTable::sweep_ended()
{
    // A new MonitoredItem needs the memory of one, if it is not larger than others.
    constexpr std::size_t items = 8;
    return ended_.sweep(items);
}

void SubscriptionTable::session_ends(Session& session, bool deletes_subscriptions)
{
    if (session.publishing == nullptr) {
        return;
    }
    PublishPart& part = PublishPart::of(session);
    const auto own = part.subscriptions(); // a copy
    if (!deletes_subscriptions) {
        // First, as it may fail: a session that continues has lost nothing.
        std::vector<std::unique_ptr<SubscriptionOwner>> owners(own.size());
        std::transform(own.begin(), own.end(), owners.begin(), [](const Subscription* one) {
            return std::make_unique<SubscriptionOwner>(one->owner());
        });
        for (std::size_t i = 0; i < own.size(); ++i) {
            own[i]->detach(std::move(owners[i]));
        }
        return part.forget_subscriptions();
    }
    for (Subscription* subscription : own) {
        subscription->handle(SubscriptionEvent::DeleteSubscriptions, {.session = &session});
        remove(*subscription);
    }
}

void SubscriptionTable::session_moved(Session& session)
{
    if (session.publishing == nullptr) {
        return;
    }
    PublishPart::of(session).refuse_others(*session.peer);
    for (Subscription* subscription : PublishPart::of(session).subscriptions()) {
        subscription->update_share();
    }
}

void SubscriptionTable::user_changed(Session& session, TimePoint now)
{
    if (session.publishing == nullptr) {
        return;
    }
    const auto& own = PublishPart::of(session).subscriptions();
    // First, as it cannot fail: none publishes with the rights of another user.
    for (Subscription* subscription : own) {
        subscription->note_user_change();
    }
    std::size_t room = ItemReviews::items_at_once;
    for (Subscription* subscription : own) {
        subscription->update_share();
        room -= reviews_.begin(*subscription, now, room);
    }
}

void SubscriptionTable::access_changed(TimePoint now)
{
    for (const auto& [id, subscription] : subscriptions_) {
        subscription->note_user_change();
    }
    std::size_t room = ItemReviews::items_at_once;
    for (const auto& [id, subscription] : subscriptions_) {
        room -= reviews_.begin(*subscription, now, room);
    }
}

void SubscriptionTable::handle_deadline(TimePoint now)
{
    // Even if a timer throws.
    const busbar::detail::Undo last{[&] { reviews_.expire(now); }};
    timers_.expire(now);
}

void SubscriptionTable::announce_change(const std::unordered_set<NodeId>& variables,
                                        std::uint32_t status_bits)
{
    for (const auto& [id, subscription] : subscriptions_) {
        if (!subscription->announce_change(variables, status_bits)) {
            sampler_->look_up_again(); // if there is no memory now
        }
    }
}

} // namespace busbar::server::detail
