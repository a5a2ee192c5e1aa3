#include "watched_subscription.hpp"

#include <algorithm>

namespace busbar::client::detail {

bool ItemWork::is_creation_done() const
{
    return std::all_of(to_create.begin(), to_create.end(),
                       [](const auto& queue) { return queue.empty(); });
}

void ItemWork::clear()
{
    *this = ItemWork{};
}

bool Refresh::is_reading() const
{
    return std::any_of(to_read.begin(), to_read.end(),
                       [](const auto& queue) { return !queue.empty(); });
}

/// What is under way has no answer; it is asked for again.
void Refresh::interrupt()
{
    is_due = is_due || is_under_way || is_reading();
    is_under_way = false;
    read.cancel();
    for (auto& queue : to_read) {
        queue.clear();
    }
}

WatchedSubscription::WatchedSubscription(SubscriptionHandle name, SubscriptionSettings wished,
                                         SubscriptionHandlers told, std::size_t max_missing)
    : handle{name}, settings{wished},
      handlers{std::make_shared<const SubscriptionHandlers>(std::move(told))}, sequence{max_missing}
{
}

DeliveryMode WatchedSubscription::mode() const
{
    switch (phase) {
    case Phase::Live:
        return DeliveryMode::Publishing;
    case Phase::Polling:
        return DeliveryMode::Polling;
    case Phase::Wished:
    case Phase::Creating:
    case Phase::Transferring:
        break;
    }
    return DeliveryMode::None;
}

} // namespace busbar::client::detail
