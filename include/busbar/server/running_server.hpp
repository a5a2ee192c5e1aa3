#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::server {

/// Is called at the end of a countdown of RunningServer.
class BUSBAR_API CountdownHeir {
public:
    /// The server has closed all connections. Returns its state from now on: Shutdown, in which it
    /// ends, or Failed, in which it accepts connections again, as after change_state(). Called
    /// within a call of the server.
    [[nodiscard]] virtual ServerState countdown_ended() = 0;

protected:
    ~CountdownHeir() = default;
};

/// An attempt of a session's user to prove a password, see RunningServer::begin_password_trial. It
/// outlives the session.
struct PasswordTrial {
    /// The name that it logged in with.
    std::string user;
    /// Thumbprint of the client's certificate; empty without security.
    std::string certificate;
    /// The client's address without its port.
    std::string address;
};

/// Changes a server while it runs. Refers to the server, on its thread.
///
/// Must not be used in a callback of the server; Methods that need it use it in
/// DataSource::handle_completions.
class BUSBAR_API RunningServer {
public:
    explicit RunningServer(Server& server) : impl_{server.impl_.get()} {}

    /// Replaces the configuration, whole or not at all: certificate, endpoints, limits, names. The
    /// problem is that of check_config, or names what cannot change in a running server
    /// (application_uri, limits.max_assembly). Sessions and Subscriptions stay, except sessions
    /// that use a removed endpoint: they end with the next handle_deadline(), so that the request
    /// that removes it is answered, and their Subscriptions wait to be transferred.
    ///
    /// With another certificate all channels with security are closed a second later, so that
    /// pending answers arrive; clients activate their sessions over new ones (Part 12, 7.10.9).
    /// Limits of channels and sessions apply to new ones.
    [[nodiscard]] Configured<void> reconfigure(ServerConfig config) const;
    /// Checks whether reconfigure() would accept it.
    [[nodiscard]] Configured<void> check(const ServerConfig& config) const;
    /// Ends the sessions of these users with their Subscriptions (Part 18, 5.2.6 and 5.2.7);
    /// returns the number of sessions.
    std::size_t end_sessions(FunctionRef<bool(const UserIdentity&)> whose) const;
    /// Visits the users of all activated sessions, each once for each of its sessions.
    void visit_users(FunctionRef<void(const UserIdentity&)> visit) const;
    /// Call it when the RoleMapper decides differently: the roles of sessions are determined again.
    void roles_changed() const;
    /// Call it when the trust list has changed. A second later, so that pending answers arrive,
    /// channels of clients whose certificate is refused now are closed (Part 12, 7.8.2.5).
    void trust_changed() const;
    /// Sets Running, Suspended or Failed (Part 5, 12.6), until the next call; false for another
    /// state, or if the server is shutting down, except that Running cancels a countdown. Clients
    /// learn of it by ServerStatus and a SystemStatusChangeEvent with `reason`. EstimatedReturnTime
    /// is `return_time`, which may be null and is for Running (Part 5, 9.4).
    ///
    /// Suspended: no data is exchanged. Values and Methods of data sources answer Bad_OutOfService,
    /// in Subscriptions too, except for the server's own sources
    /// (DataSourceOptions::is_always_in_service); ServiceLevel is in Maintenance, 0. Sessions and
    /// Subscriptions stay, all services work, values in the address space itself are read and
    /// written, and events are reported: clients return to what they had.
    ///
    /// Failed: the same with Bad_ServerHalted, and services other than those of Discovery and
    /// Session, Read, Call and Publish are refused with it, so that clients see the server's state
    /// and an administrator can request another one; ServiceLevel is NoData, 1.
    bool change_state(ServerState state, std::string_view reason, DateTime return_time) const;
    /// Server::begin_shutdown with an administrator's settings: connections are closed `delay`
    /// later, and EstimatedReturnTime is `return_time`, which may be null. False if it has begun
    /// already.
    bool begin_shutdown(std::string_view reason, std::chrono::seconds delay,
                        DateTime return_time) const;
    /// Begins a shutdown that change_state can cancel until it is over, and during which Call works
    /// too, with the Methods of sources that are always in service. `heir` is called when the delay
    /// is over, or no client is connected any more, but not if another shutdown replaces this one.
    /// It must outlive that.
    bool begin_countdown(std::string_view reason, std::chrono::seconds delay, DateTime return_time,
                         CountdownHeir& heir) const;
    [[nodiscard]] ServerState state() const;
    /// The latest time that was passed to the server.
    [[nodiscard]] TimePoint latest_time() const;
    /// Returns a trial if the session's user may be asked for a password again: the login guard has
    /// not locked this user at this client (Part 4, 5.7.3.1). Nothing once the session is over.
    [[nodiscard]] std::optional<PasswordTrial> begin_password_trial(const NodeId& session_id) const;
    /// Counts the trial as one of a login, also if the session is over or has another user.
    void password_tried(const PasswordTrial& trial, bool was_right) const;
    /// Checks a Call again that has waited: Good, or why the session's user may not make it any
    /// more. Good if Object or Method are gone, which the Method itself will report.
    [[nodiscard]] StatusCode check_call(const NodeId& session_id, const NodeId& object,
                                        const NodeId& method) const;
    /// Counts the users of a session: another number means another user, or the same user after
    /// another one. Nothing once the session is over.
    [[nodiscard]] std::optional<std::uint32_t> user_number(const NodeId& session_id) const;

    /// The key of the session's share of common places: equal for all sessions of one user, and for
    /// anonymous users of one network. Empty once the session is over.
    [[nodiscard]] std::string share_key(const NodeId& session_id) const;

private:
    Server::Impl* impl_;
};

} // namespace busbar::server
