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

/// The hosts by which clients reach the machine as it is now, from its configuration and its
/// network interfaces (see known_hosts).
[[nodiscard]] std::vector<std::string> present_hosts(const ControllerConfig& config);

/// How often it looks.
inline constexpr std::chrono::seconds lookout_period{60};

/// What nobody tells a controller that runs, and it has to look at: whether its own certificate
/// still names the machine's addresses (W588, 3-2-2; event 15020000), and whether certificates
/// of clients have expired (5-1-1).
///
/// On the server's thread.
class Lookout {
public:
    using Hosts = std::function<std::vector<std::string>()>;

    /// `hosts` gives what ServerConfig::host_names should have now. Clients' certificates are those
    /// in `clients`; null: everybody is trusted. All must outlive it. `changed` is called when the
    /// server has got other names, in look(); it may be null.
    Lookout(server::Server& server, crypto::CertificateStore* clients, const WallClock& clock,
            LogSink& log, Hosts hosts, std::function<void()> changed = {});

    /// At the start, after a change, and from then on at least once a day: what comes up is told
    /// once, records go to the log. Not in a callback of the server's.
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
