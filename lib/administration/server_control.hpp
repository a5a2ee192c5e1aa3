#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <busbar/administration/administration.hpp>
#include <busbar/core/log.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/enumerations.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// RequestServerStateChange of the Server object (Part 5, 9.4): Running, Suspended and Failed as
/// RunningServer::change_state has them, and Shutdown. The other states say how a server finds
/// itself: who asks for one gets Bad_InvalidState.
///
/// A Shutdown counts down (Part 5, 12.10), and Running takes it back until it is over. After it the
/// program ends, or goes on without its server, which is Failed then.
///
/// A restart is a Shutdown after which the program starts again and is Running, so that it is taken
/// with these two states only.
class ServerControl final : private server::CountdownHeir {
public:
    struct Needs {
        server::Server& server;
        NodeTable& table;
        LogSink& log;
        /// What ends what serves, for good and to start again, see AdministrationParts.
        const std::function<void()>& stop;
        const std::function<void(const std::string&)>& shut_down;
        const std::function<Configured<void>()>& may_run;
        const std::function<void()>& restart;
        const std::function<void(const RestartWish&)>& replace;
        const std::function<Configured<void>()>& may_replace;
    };

    explicit ServerControl(const Needs& needs) : needs_{needs} {}

    /// The problem says what is missing in namespace 0.
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
    /// Good, or what the Method answers.
    [[nodiscard]] Checked<void> check(const Wish& wish) const;
    void carry_out(const Wish& wish);
    /// Whether what the server is out for can be ended by Running.
    [[nodiscard]] Checked<void> check_run() const;
    [[nodiscard]] ServerState countdown_ended() override;

    Needs needs_;
    // Of the countdown.
    bool restarts_{false};
    std::string reason_;
};

} // namespace busbar::administration::detail
