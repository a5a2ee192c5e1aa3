#include "lookout.hpp"

#include <utility>

#include <busbar/server/running_server.hpp>

#include "product/configuration/addresses.hpp"

namespace busbar::product {

std::vector<std::string> present_hosts(const ControllerConfig& config)
{
    return known_hosts(config, machine_name(), interface_addresses());
}

Lookout::Lookout(server::Server& server, crypto::CertificateStore* clients, const WallClock& clock,
                 LogSink& log, Hosts hosts, std::function<void()> changed)
    : server_{server}, clients_{clients}, clock_{clock}, log_{log}, hosts_{std::move(hosts)},
      changed_{std::move(changed)}, trusted_{log,
                                             std::string{crypto::name(crypto::StoreList::Trusted)}}
{
}

void Lookout::look()
{
    look_at_hosts();
    if (clients_ != nullptr) {
        const DateTime now = clock_.now();
        // Each is reported once, however often this runs.
        static_cast<void>(trusted_.check(clients_->trust_list(now).trusted, now));
    }
}

/// Sets the hosts; the server checks its certificate when they change.
void Lookout::look_at_hosts()
{
    std::vector<std::string> hosts = hosts_();
    if (hosts == server_.config().host_names) {
        return;
    }
    server::ServerConfig next = server_.config();
    next.host_names = std::move(hosts);
    const auto done = server::RunningServer{server_}.reconfigure(std::move(next));
    if (!done) {
        log_.write(LogLevel::Error, "controller",
                   "the machine has other addresses, which the server cannot have: " +
                       text(done.error()));
    } else if (changed_) {
        changed_();
    }
}

} // namespace busbar::product
