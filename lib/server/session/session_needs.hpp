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

/// What others have to do when something becomes of a session.
class SessionKeeper {
public:
    SessionKeeper() = default;
    SessionKeeper(const SessionKeeper&) = delete;
    SessionKeeper& operator=(const SessionKeeper&) = delete;

    /// Ends what the session has pending with `status`, then the session itself. Its Subscriptions
    /// live on, for another session to take over, unless they are to be deleted with it.
    virtual void close_session(Session& session, StatusCode status, bool deletes_subscriptions) = 0;
    /// It was activated, perhaps over another channel than before.
    virtual void session_activated(Session& session) = 0;
    /// It has another user, or the same one with other rights.
    virtual void user_changed(Session& session, TimePoint now) = 0;
    /// Ends the session's requests with this handle; how many there were (Part 4, 5.7.5).
    [[nodiscard]] virtual std::uint32_t cancel(const Session& session,
                                               std::uint32_t request_handle) = 0;

protected:
    ~SessionKeeper() = default;
};

/// What the Discovery and Session services need of the server; as long as that lives.
struct SessionNeeds {
    const ServerConfig& config;
    /// The guarded one.
    const ServerEnvironment& environment;
    Guards& guards;
    /// As bounded as what peers cause has to be.
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
    /// When the server was made.
    DateTime start_time{};

    [[nodiscard]] const ServerLimits& limits() const { return config.limits; }
    [[nodiscard]] DateTime wall_time() const { return environment.wall_clock->now(); }
};

} // namespace busbar::server::detail
