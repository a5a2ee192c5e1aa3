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

/// Who wants to know what Subscriptions there are.
class SubscriptionObserver {
public:
    SubscriptionObserver() = default;
    SubscriptionObserver(const SubscriptionObserver&) = delete;
    SubscriptionObserver& operator=(const SubscriptionObserver&) = delete;

    virtual void added(const Subscription& subscription) = 0;
    /// It has another session.
    virtual void moved(const Subscription& subscription) = 0;
    /// It is about to end.
    virtual void removed(const Subscription& subscription) = 0;

protected:
    ~SubscriptionObserver() = default;
};

/// What Subscriptions and their items need of the server; as long as that lives.
struct SubscriptionNeeds {
    const model::AddressSpace& space;
    DataSources& sources;
    const binary::TypeRegistry& types;
    const ServerLimits& limits;
    /// The guarded one.
    const ServerEnvironment& environment;
    Counters& counters;
    const LiveValues& live_values;
    /// As bounded as what peers cause has to be.
    LogSink& log;
    /// Null in a server without events.
    EventItems* event_items{nullptr};
    /// May be null.
    SubscriptionObserver* observer{nullptr};

    [[nodiscard]] DateTime wall_time() const { return environment.wall_clock->now(); }
};

} // namespace busbar::server::detail
