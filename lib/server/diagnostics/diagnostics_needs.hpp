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

/// Where a server is between its start and its end (Part 5, 12.10).
struct ServerLife {
    explicit ServerLife(DateTime start) : start_time{start}, return_time{start} {}

    DateTime start_time;
    ServerState state{ServerState::Running};
    std::string shutdown_reason;
    DateTime shutdown_time;
    /// When it is there again, as whoever stops it says; of one that runs, when it came.
    DateTime return_time;

    [[nodiscard]] bool is_shutting_down() const { return state == ServerState::Shutdown; }
};

/// What the diagnostics look at; as long as the server lives.
struct DiagnosticsNeeds {
    /// Changed for the Objects of sessions only.
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
