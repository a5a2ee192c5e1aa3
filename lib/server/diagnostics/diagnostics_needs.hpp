#pragma once

#include <cstdint>
#include <string>

#include <busbar/model/address_space.hpp>
#include <busbar/server/conformance.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/enumerations.hpp>

#include "server/session/counters.hpp"
#include "server/session/session_table.hpp"
#include "server/subscription/subscription_table.hpp"

namespace busbar::server::detail {

/// The life of a server from its start to its end (Part 5, 12.10).
struct ServerLife {
    explicit ServerLife(DateTime start) : start_time{start}, return_time{start} {}

    DateTime start_time;
    ServerState state{ServerState::Running};
    std::string shutdown_reason;
    DateTime shutdown_time;
    /// The expected return, set by the code that stops it; for a running server, the time of its
    /// start.
    DateTime return_time;

    [[nodiscard]] bool is_shutting_down() const { return state == ServerState::Shutdown; }
};

/// The objects that the diagnostics read; valid as long as the server.
struct DiagnosticsNeeds {
    /// Changed only for the Objects of sessions.
    model::AddressSpace& space;
    const ServerConfig& config;
    const WallClock& wall_clock;
    const ServerLife& life;
    const Counters& counters;
    const SessionTable& sessions;
    const SubscriptionTable& subscriptions;
    /// Index of the ApplicationUri in the NamespaceArray.
    std::uint16_t own_namespace;
    const Conformance& conformance;

    [[nodiscard]] const ServerLimits& limits() const { return config.limits; }
};

} // namespace busbar::server::detail
