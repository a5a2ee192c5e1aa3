#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <busbar/administration/administration.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>
#include <busbar/types/enumerations.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// Implements RequestServerStateChange of the Server object (Part 5, 9.4) with Running, Suspended
/// and Failed as in RunningServer::change_state, and with Shutdown. The other states describe what
/// a server detects itself; requesting one gives Bad_InvalidState.
///
/// A Shutdown counts down (Part 5, 12.10), and Running cancels it until the countdown is over. Then
/// the program ends, or continues without its server, which is in the state Failed.
///
/// A restart is a Shutdown after which the program starts again in the state Running, so that only
/// these two states can request it.
class ServerControl final : private server::CountdownHeir {
public:
    struct Needs {
        server::Server& server;
        NodeTable& table;
        LogSink& log;
        /// Checks whether another server can take the place; if null, the server's thread does.
        server::Worker* worker;
        /// Functions that end, stop or start the server, see AdministrationParts.
        const std::function<void()>& stop;
        const std::function<void(const std::string&)>& shut_down;
        const std::function<Configured<void>()>& may_run;
        const std::function<void()>& restart;
        const std::function<void(const RestartWish&)>& replace;
        const std::function<std::function<Configured<void>()>()>& may_replace;
    };

    explicit ServerControl(const Needs& needs) : needs_{needs} {}

    /// Connects the Method; the problem names what is missing in namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    struct Wish {
        ServerState state{};
        DateTime return_time;
        std::uint32_t seconds_till_shutdown{0};
        std::string reason;
        bool restarts{false};

        [[nodiscard]] bool ends_server() const
        {
            return state == ServerState::Shutdown || restarts;
        }
    };

    void request(server::MethodCall call);
    /// Returns Good or the refusal for the Method's answer.
    [[nodiscard]] Checked<void> check(const Wish& wish) const;
    /// Checks on the worker whether another server can take the place of this one, and agrees.
    void agree_if_replaceable(server::MethodCall call, Wish wish);
    /// Answers, and does what is wished afterwards.
    void agree(server::MethodCall& call, Wish wish);
    void carry_out(const Wish& wish);
    /// Tells whether Running can end the state that the server is in.
    [[nodiscard]] Checked<void> check_run() const;
    [[nodiscard]] ServerState countdown_ended() override;

    Needs needs_;
    // Of the countdown.
    bool restarts_{false};
    std::string reason_;
};

/// Implements ResetToServerDefaults of ServerConfiguration (Part 12, 7.10.13): forgets the changes
/// of administrators and ends the server, after warning its clients.
class ServerReset {
public:
    /// See AdministrationParts.
    struct Needs {
        server::Server& server;
        NodeTable& table;
        LogSink& log;
        const std::function<Configured<void>()>& reset;
        /// Ends the program, which may start again.
        const std::function<void()>& end;
    };

    explicit ServerReset(const Needs& needs) : needs_{needs} {}

    /// Connects the Method, after ServerConfiguration. The problem names what is missing in
    /// namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    void reset(server::MethodCall& call);

    Needs needs_;
};

} // namespace busbar::administration::detail
