#include <busbar/client/subscriptions.hpp>

namespace busbar::client {

struct Subscriptions::Impl {};

Subscriptions::Subscriptions(Requester& /*requester*/, SubscriptionLimits /*limits*/) {}
Subscriptions::~Subscriptions() = default;

void Subscriptions::session_started(SessionStart /*how*/) {}
void Subscriptions::session_lost() {}

TimePoint Subscriptions::next_deadline() const
{
    return no_deadline;
}

void Subscriptions::handle_deadline(TimePoint /*now*/) {}

} // namespace busbar::client
