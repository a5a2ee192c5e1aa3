#include <busbar/client/subscriptions.hpp>

#include "subscription/engine.hpp"

namespace busbar::client {

struct Subscriptions::Impl : detail::SubscriptionEngine {
    using SubscriptionEngine::SubscriptionEngine;
};

Subscriptions::Subscriptions(Requester& requester, SubscriberLimits limits)
    : impl_{std::make_unique<Impl>(requester, limits)}
{
}

Subscriptions::~Subscriptions() = default;

Result<SubscriptionHandle> Subscriptions::create(SubscriptionSettings settings,
                                                 SubscriptionHandlers handlers)
{
    return impl_->wishes().create(settings, std::move(handlers));
}

Result<void> Subscriptions::modify(SubscriptionHandle subscription, SubscriptionSettings settings)
{
    return impl_->wishes().modify(subscription, settings);
}

Result<void> Subscriptions::remove(SubscriptionHandle subscription)
{
    return impl_->wishes().remove(subscription);
}

Result<std::vector<ItemHandle>> Subscriptions::add_items(SubscriptionHandle subscription,
                                                         std::vector<ItemSettings> items)
{
    return impl_->wishes().add_items(subscription, std::move(items));
}

Result<void> Subscriptions::modify_items(std::span<const ItemHandle> items,
                                         const ItemSettings& settings)
{
    return impl_->wishes().modify_items(items, settings);
}

Result<void> Subscriptions::remove_items(std::span<const ItemHandle> items)
{
    return impl_->wishes().remove_items(items);
}

Result<void> Subscriptions::set_triggering(ItemHandle trigger, std::vector<ItemHandle> links)
{
    return impl_->wishes().set_triggering(trigger, std::move(links));
}

DeliveryMode Subscriptions::mode(SubscriptionHandle subscription) const
{
    const auto* found = impl_->find(subscription);
    return found == nullptr || !impl_->has_session() ? DeliveryMode::None : found->mode();
}

std::uint32_t Subscriptions::server_id(SubscriptionHandle subscription) const
{
    const auto* found = impl_->find(subscription);
    return found == nullptr ? 0 : found->server_id;
}

void Subscriptions::session_started(SessionStart how)
{
    impl_->session_started(how == SessionStart::New);
}

void Subscriptions::session_lost()
{
    impl_->session_lost();
}

TimePoint Subscriptions::next_deadline() const
{
    return impl_->next_deadline();
}

void Subscriptions::handle_deadline(TimePoint now)
{
    impl_->handle_deadline(now);
}

} // namespace busbar::client
