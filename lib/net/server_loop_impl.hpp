#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/signal_set.hpp>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/net/server_loop.hpp>

#include "discovery_registration.hpp"
#include "listeners.hpp"
#include "memory_return.hpp"
#include "pipe_waker.hpp"
#include "reverse_dialer.hpp"
#include "served_server.hpp"
#include "turn_away.hpp"

namespace busbar::net {

/// The state of a loop and its servers. Everything is on the thread of run(), except the waker.
struct ServerLoop::Impl {
    using ServedServer = detail::ServedServer;
    using Socket = asio::ip::tcp::socket;

    explicit Impl(LogSink& l);

    std::optional<std::uint64_t> adopt(Socket socket, ServedServer::Direction direction,
                                       std::uint32_t listener = 0);
    /// Calls `work`, which may throw, and handles the work that it caused.
    template <typename Work>
    void guard(std::string_view name, Work work)
    {
        busbar::detail::guarded(log, name, work);
        after_activity();
    }
    /// Calls `work` with each server. Further ones may exist afterwards.
    template <typename Work>
    void for_each(Work work)
    {
        for (std::size_t i = 0; i < served.size(); ++i) {
            work(*served[i]);
        }
    }
    void serve(server::Server& server);
    [[nodiscard]] Configured<void> check(const server::Server& next,
                                         const Handover& handover) const;
    [[nodiscard]] Configured<void> check_next(const server::Server& next) const;
    void retire();
    void after_activity();
    void await_deadline();
    void handle_deadline();
    [[nodiscard]] bool turn(TimePoint until);
    void begin_stop();
    void tell_to_stop();
    [[nodiscard]] bool resume();
    void begin(server::Server& server);
    void run(TimePoint until);
    void end();
    void await_wake();
    void await_hangup();
    [[nodiscard]] bool has_stopped() const;

    busbar::detail::SafeLog log;
    asio::io_context context;
    /// Without it a turn, or a context without waits, would end at once.
    asio::executor_work_guard<asio::io_context::executor_type> work{context.get_executor()};
    detail::PipeWaker waker;
    detail::MemoryReturn memory_return;
    /// Made when they are wanted: Asio's service of signals, if its construction fails for lack of
    /// memory, stays in a list of the process (Asio 1.22).
    std::optional<asio::signal_set> signals;
    std::optional<asio::signal_set> hangup;
    std::function<void()> on_hangup;
    /// Peers that are being refused for lack of room.
    detail::TurnAway turn_away{16};
    detail::Listeners listeners{context.get_executor(), log};
    ReverseConnectConfig reverse_connect;
    std::vector<std::unique_ptr<detail::ReverseDialer>> dialers;
    std::vector<std::unique_ptr<detail::DiscoveryRegistration>> registrations;
    detail::ServedEvents events;
    /// The last one serves, the earlier ones are ending. Empty before run().
    std::vector<std::unique_ptr<ServedServer>> served;
    std::uint64_t last_connection{0};
    /// The next one of the servers and of memory_return. Asio has no timer for it, as setting one
    /// takes two system calls at each change; waiting for sockets until then takes none.
    TimePoint deadline{no_deadline};
    /// Whether the last turn was for a deadline.
    bool had_deadline{false};
    /// Whether waits may be missing after an exception.
    bool is_behind{false};
    bool awaits_hangup{false};
    bool is_stopping{false};
    bool is_told_to_stop{false}; // everything is
};

} // namespace busbar::net
