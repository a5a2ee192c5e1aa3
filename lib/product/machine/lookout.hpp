#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/trusted_certificate_watch.hpp>
#include <busbar/server/server.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The present hosts by which clients reach the machine, from its configuration and its network
/// interfaces (see known_hosts).
[[nodiscard]] std::vector<std::string> present_hosts(const ControllerConfig& config);

/// Interval between checks.
inline constexpr std::chrono::seconds lookout_period{60};

/// Watches facts that change without notice while a controller runs: whether its own certificate
/// still names the machine's addresses (W588, 3-2-2; event 15020000), and whether clients'
/// certificates have expired (5-1-1).
///
/// Used on the server's thread.
class Lookout {
public:
    using Hosts = std::function<std::vector<std::string>()>;

    /// `hosts` returns what ServerConfig::host_names should be. `clients` has the clients'
    /// certificates; null if all clients are trusted. All arguments must outlive this object.
    /// look() calls `changed`, which may be null, when the server has new names.
    Lookout(server::Server& server, crypto::CertificateStore* clients, const WallClock& clock,
            LogSink& log, Hosts hosts, std::function<void()> changed = {});

    /// Call it at the start, after a change, and at least once a day, but not in a callback of the
    /// server. Each finding is reported once; records go to the log.
    void look();

private:
    void look_at_hosts();

    server::Server& server_;
    crypto::CertificateStore* clients_;
    const WallClock& clock_;
    LogSink& log_;
    Hosts hosts_;
    std::function<void()> changed_;
    crypto::TrustedCertificateWatch trusted_;
};

} // namespace busbar::product
