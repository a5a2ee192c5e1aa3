#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <busbar/client/connection.hpp>

#include "pending_requests.hpp"
#include "session.hpp"

namespace busbar::client {

namespace detail {

enum class ConnectionState : std::uint8_t {
    Connecting,
    Resuming,
    Creating,
    Activating,
    Ready,
    Closed
};

} // namespace detail

struct Connection::Impl {
    using State = detail::ConnectionState;

    /// A pending change of the session's user.
    struct UserChange {
        std::uint32_t handle{0};
        UserIdentity identity;
        std::optional<UserTokenPolicy> token_policy;
    };

    Impl(ConnectionConfig c, const channel::ChannelEnvironment& e, TimePoint start)
        : config{std::move(c)},
          environment{e}, channel{config.channel, environment, start}, now{start}
    {
    }

    [[nodiscard]] Result<std::uint32_t>
    send(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode, Duration timeout = {},
         std::uint64_t context = 0);
    template <typename Request>
    [[nodiscard]] Result<void> send(Request& request);
    void handle(channel::ChannelEvent event);
    void handle_opened();
    void handle_response(channel::ChannelEvent event);
    void create_session();
    void session_created(const ConnectionEvent& event);
    void activate_session(State next);
    void session_activated(const ConnectionEvent& event);
    void become_ready();
    void close_session(bool deletes_subscriptions);
    [[nodiscard]] bool has_session() const;
    void tell_cancelled(std::uint32_t request_handle);
    [[nodiscard]] Result<std::uint32_t> change_user(UserChange change);
    void user_changed(ConnectionEvent& event);
    void abandon(StatusCode status);
    void end(StatusCode status);

    ConnectionConfig config;
    channel::ChannelEnvironment environment;
    channel::ClientChannel channel;
    detail::SessionData session;
    State state{State::Connecting};
    bool is_resumed{false};
    TimePoint now;
    std::uint32_t last_request_handle{0};
    detail::PendingRequests pending;
    std::deque<ConnectionEvent> events;
    std::optional<UserChange> user_change;
};

} // namespace busbar::client
