#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/server/server.hpp>

namespace busbar::server {

/// Change of a server while it runs. Refers to the server, on its thread.
///
/// Not to be used from a callback of the server's; Methods that want to, do it in
/// DataSource::handle_completions.
class BUSBAR_API RunningServer {
public:
    explicit RunningServer(Server& server) : impl_{server.impl_.get()} {}

    /// Another configuration, whole or not at all: certificate, endpoints, limits, names. The
    /// problem is that of check_config, or names what cannot change in a running server
    /// (application_uri, limits.max_assembly). Sessions and Subscriptions stay, but sessions that
    /// use an endpoint that is gone, whose Subscriptions wait to be transferred.
    ///
    /// With another certificate all channels with security are closed a second later, so that
    /// answers under way arrive; clients activate their sessions over new ones (Part 12, 7.10.9).
    /// Limits of channels and sessions hold for new ones.
    [[nodiscard]] Configured<void> reconfigure(ServerConfig config) const;
    /// Whether reconfigure() would take it.
    [[nodiscard]] Configured<void> check(const ServerConfig& config) const;
    /// Ends the sessions of these users with their Subscriptions (Part 18, 5.2.6 and 5.2.7); how
    /// many there were.
    std::size_t end_sessions(FunctionRef<bool(const UserIdentity&)> whose) const;
    /// The RoleMapper decides otherwise than before: sessions get their roles anew.
    void roles_changed() const;
    /// Other certificates are trusted than before. A second later, so that answers under way
    /// arrive, channels of clients whose certificate is refused now are closed (Part 12, 7.8.2.5).
    void trust_changed() const;
    /// Server::begin_shutdown with what an administrator asked for: connections are closed `delay`
    /// later, and EstimatedReturnTime says `return_time`, which may be null. False if it has begun
    /// already.
    bool begin_shutdown(std::string_view reason, std::chrono::seconds delay,
                        DateTime return_time) const;
    /// False once it is over.
    [[nodiscard]] bool has_session(const NodeId& session_id) const;

private:
    Server::Impl* impl_;
};

} // namespace busbar::server
