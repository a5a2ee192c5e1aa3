#pragma once

#include <cstdint>

#include <busbar/server/environment.hpp>
#include <busbar/server/server_config.hpp>

#include "counters.hpp"
#include "server/users/guards.hpp"
#include "server/users/login_guard.hpp"
#include "server/users/password_checks.hpp"
#include "server/users/user_token.hpp"
#include "session_table.hpp"

namespace busbar::server::detail {

/// Notified of changes of a session that others must act on.
class SessionKeeper {
public:
    SessionKeeper() = default;
    SessionKeeper(const SessionKeeper&) = delete;
    SessionKeeper& operator=(const SessionKeeper&) = delete;

    /// Ends the session's pending requests with `status`, then the session itself. Its
    /// Subscriptions survive, for another session to take over, unless they shall be deleted with
    /// it.
    virtual void close_session(Session& session, StatusCode status, bool deletes_subscriptions) = 0;
    /// The session was activated, perhaps over another channel than before.
    virtual void session_activated(Session& session) = 0;
    /// The session has another user, or the same one with other rights.
    virtual void user_changed(Session& session, TimePoint now) = 0;
    /// Ends the session's requests with this handle; returns their number (Part 4, 5.7.5).
    [[nodiscard]] virtual std::uint32_t cancel(const Session& session,
                                               std::uint32_t request_handle) = 0;

protected:
    ~SessionKeeper() = default;
};

/// The needs of the Discovery and Session services; valid as long as the server.
struct SessionNeeds {
    const ServerConfig& config;
    /// The guarded environment.
    const ServerEnvironment& environment;
    Guards& guards;
    /// A rationed log, since peers can cause messages.
    LogSink& log;
    SessionTable& sessions;
    LoginGuard& logins;
    PasswordChecks& password_checks;
    Counters& counters;
    SessionKeeper& keeper;
    /// Index of the ApplicationUri in the NamespaceArray.
    std::uint16_t own_namespace;
    /// Null in a server without issued tokens.
    IssuedLogin* log_in_issued{nullptr};
    /// The time when the server was created.
    DateTime start_time{};

    [[nodiscard]] const ServerLimits& limits() const { return config.limits; }
    [[nodiscard]] DateTime wall_time() const { return environment.wall_clock->now(); }
};

} // namespace busbar::server::detail
