#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::server {

/// Goes on where a countdown of RunningServer ends.
class BUSBAR_API CountdownHeir {
public:
    /// The server has closed all connections. In a call of the server's.
    virtual void countdown_ended() = 0;

protected:
    ~CountdownHeir() = default;
};

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
    /// The users of all sessions that are activated, each as often as it has sessions.
    void visit_users(FunctionRef<void(const UserIdentity&)> visit) const;
    /// The RoleMapper decides otherwise than before: sessions get their roles anew.
    void roles_changed() const;
    /// Other certificates are trusted than before. A second later, so that answers under way
    /// arrive, channels of clients whose certificate is refused now are closed (Part 12, 7.8.2.5).
    void trust_changed() const;
    /// Running, Suspended or Failed (Part 5, 12.6), for as long as nobody changes it back; false
    /// for another state, or if the server is shutting down: Running alone takes a countdown back.
    /// Clients are told by ServerStatus and a
    /// SystemStatusChangeEvent with `reason`. EstimatedReturnTime says `return_time`, which may be
    /// null and is for Running (Part 5, 9.4).
    ///
    /// Suspended: no data comes or goes. Values and Methods of data sources answer
    /// Bad_OutOfService, in Subscriptions too, but for sources of the server's own
    /// (DataSourceOptions::is_always_in_service); ServiceLevel is in Maintenance, 0. Sessions and
    /// Subscriptions stay, all services work, what the address space itself keeps is read and
    /// written, and events are told: clients come back to what they had.
    ///
    /// Failed: the same with Bad_ServerHalted, and services other than those of Discovery and
    /// Session, Read, Call and Publish are refused with it, so that clients see how the server is
    /// and an administrator can ask for another state; ServiceLevel is NoData, 1.
    bool change_state(ServerState state, std::string_view reason, DateTime return_time) const;
    /// Server::begin_shutdown with what an administrator asked for: connections are closed `delay`
    /// later, and EstimatedReturnTime says `return_time`, which may be null. False if it has begun
    /// already.
    bool begin_shutdown(std::string_view reason, std::chrono::seconds delay,
                        DateTime return_time) const;
    /// The same for a shutdown that change_state can take back until it is over, for which Call
    /// works too, with the Methods of sources that are always in service. `heir` is told when the
    /// delay is over, or nobody is connected any more, but not if another shutdown takes the place
    /// of this one. It must outlive that.
    bool begin_countdown(std::string_view reason, std::chrono::seconds delay, DateTime return_time,
                         CountdownHeir& heir) const;
    [[nodiscard]] ServerState state() const;
    /// The latest time that the server was told.
    [[nodiscard]] TimePoint latest_time() const;
    /// Whether the user of the session may be asked for a password again: the guard of logins has
    /// not locked this user at this client (Part 4, 5.7.3.1). False once the session is over.
    [[nodiscard]] bool may_try_password(const NodeId& session_id) const;
    /// Counts the password that was tried as one of a login.
    void password_tried(const NodeId& session_id, bool was_right) const;
    /// For a Call that has waited since it was checked: Good, or why the session's user may not
    /// make it any more. Good if Object or Method are gone, of which the Method itself will tell.
    [[nodiscard]] StatusCode check_call(const NodeId& session_id, const NodeId& object,
                                        const NodeId& method) const;
    /// Counts the users of a session: another number is another user's, or the same user's after
    /// another. Nothing once the session is over.
    [[nodiscard]] std::optional<std::uint32_t> user_number(const NodeId& session_id) const;

    /// Whose share of common places the session counts to: equal for all sessions of one user, and
    /// for anonymous users of one network. Empty once the session is over.
    [[nodiscard]] std::string share_key(const NodeId& session_id) const;

private:
    Server::Impl* impl_;
};

} // namespace busbar::server
