#pragma once

#include <busbar/binary/type_registry.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/environment.hpp>
#include <busbar/server/limits.hpp>

#include "server/data/data_sources.hpp"
#include "server/rights/live_values.hpp"
#include "server/session/counters.hpp"

namespace busbar::server::detail {

class EventItems;
class Subscription;

/// Is notified of which Subscriptions exist.
class SubscriptionObserver {
public:
    SubscriptionObserver() = default;
    SubscriptionObserver(const SubscriptionObserver&) = delete;
    SubscriptionObserver& operator=(const SubscriptionObserver&) = delete;

    virtual void added(const Subscription& subscription) = 0;
    /// The Subscription has another session.
    virtual void moved(const Subscription& subscription) = 0;
    /// The Subscription is about to end.
    virtual void removed(const Subscription& subscription) = 0;

protected:
    ~SubscriptionObserver() = default;
};

/// The needs of Subscriptions and their items; valid as long as the server.
struct SubscriptionNeeds {
    const model::AddressSpace& space;
    DataSources& sources;
    const binary::TypeRegistry& types;
    const ServerLimits& limits;
    /// The guarded environment.
    const ServerEnvironment& environment;
    Counters& counters;
    const LiveValues& live_values;
    /// A rationed log, since peers can cause messages.
    LogSink& log;
    /// Null in a server without events.
    EventItems* event_items{nullptr};
    /// May be null.
    SubscriptionObserver* observer{nullptr};
    DateTime start_time{};

    [[nodiscard]] DateTime wall_time() const { return environment.wall_clock->now(); }
};

} // namespace busbar::server::detail
