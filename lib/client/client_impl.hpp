#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include <busbar/client/client.hpp>
#include <busbar/client/connection.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "reconnect.hpp"
#include "request_queue.hpp"
#include "server_info.hpp"
#include "transport.hpp"

namespace busbar::client::detail {

/// Decides when to send a request to a silent server, and when to give up.
class KeepAlive {
public:
    enum class Action : std::uint8_t { None, Ask, GiveUp };

    /// Starts again; with an interval of zero it never asks.
    void start(TimePoint now, Duration interval)
    {
        interval_ = interval;
        heard(now);
    }
    void stop() { deadline_ = no_deadline; }
    void heard(TimePoint now)
    {
        unanswered_ = 0;
        deadline_ = interval_ > Duration::zero() ? now + interval_ : no_deadline;
    }
    [[nodiscard]] Action due(TimePoint now)
    {
        if (now < deadline_) {
            return Action::None;
        }
        if (unanswered_ == 2) {
            return Action::GiveUp;
        }
        ++unanswered_;
        deadline_ = now + interval_;
        return Action::Ask;
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    [[nodiscard]] Duration interval() const { return interval_; }

private:
    Duration interval_{0};
    TimePoint deadline_{no_deadline};
    int unanswered_{0};
};

} // namespace busbar::client::detail

namespace busbar::client {

/// A session without a connection.
struct KeptSession {
    SessionTicket ticket;
    channel::SecuritySetting security;
    std::string server_uri;
    TimePoint ends_at{no_deadline};
    /// Number of connections that were lost while they resumed it.
    int failures{0};
};

/// A change of the user that has not been reported yet.
struct PendingUserChange {
    UserIdentity identity;
    UserTokenPolicy token_policy;
    std::function<void(StatusCode)> done;
    /// Handle of the request; 0 if none is under way.
    std::uint32_t handle{0};
    std::optional<StatusCode> result;
};

/// The steps of poll(), one of each kind in turn, so that none delays the others. A step returns
/// true if there was something to do.
struct Client::Impl {
    Impl(Client& owner, ClientConfig c, const channel::ChannelEnvironment& e, TimePoint start);

    void tell(TimePoint time);
    void survive(FunctionRef<void()> work);
    bool end_failed();
    [[nodiscard]] bool has_work() const;
    [[nodiscard]] TimePoint next_deadline() const;

    // Steps (client.cpp).
    bool announce();
    bool tell_user_change();
    bool deliver();
    bool expire();
    bool run_subscriptions();
    bool send_waiting();
    // Steps (client_events.cpp and client_attempt.cpp).
    bool receive();
    bool advance();

    // Events of the connection (client_events.cpp).
    void handle(ConnectionEvent event);
    void connection_ready();
    void handle_response(ConnectionEvent event);
    void endpoints_arrived(const ConnectionEvent& event);
    void info_arrived(const ConnectionEvent& event);
    void state_arrived(const ConnectionEvent& event);
    void become_ready();
    void begin_user_change(PendingUserChange change);
    void user_change_arrived(PendingUserChange& change, StatusCode status);
    template <typename Request>
    void ask(Request request, std::uint32_t& handle, Duration timeout = {});
    void keep_alive_due();

    // Transitions between attempts (client_attempt.cpp).
    void set_state(ClientState next, StatusCode why);
    bool go_on();
    void begin_attempt();
    void open_transport();
    [[nodiscard]] bool is_discovering() const;
    [[nodiscard]] ConnectionConfig connection_config() const;
    void use_connection();
    void drop_connection(bool keeps_session);
    [[nodiscard]] Checked<void> check_certificate(const EndpointChoice& chosen) const;
    void choose(const Array<EndpointDescription>& offered);
    [[nodiscard]] bool is_channel_chosen() const;
    [[nodiscard]] bool may_dial_again(StatusCode why) const;
    void dial_again(StatusCode why);
    [[nodiscard]] bool may_go_where_reached(StatusCode why) const;
    void go_where_reached(StatusCode why);
    /// The attempt, or the connection that was Ready, ends.
    void lose(StatusCode why);
    void keep_session();
    void end_session();
    [[nodiscard]] bool may_retry(StatusCode why, bool is_choice_doubtful) const;
    void retry_later(StatusCode why);
    void begin_closing(StatusCode why);
    [[nodiscard]] std::string text_of_loss(StatusCode why) const;

    Client& client;
    ClientConfig config;
    busbar::detail::SafeLog safe_log;
    /// With the log above, so that writing never throws.
    channel::ChannelEnvironment environment;
    TimePoint now;

    ClientState state{ClientState::Waiting};
    StatusCode last_error;
    std::function<void(ClientState, StatusCode)> state_handler;
    std::deque<std::pair<ClientState, StatusCode>> changes;

    /// The reason why the connection must end.
    StatusCode failure;
    bool is_wanted{false};
    bool deletes_subscriptions{true};
    detail::BackOff back_off;
    std::uint32_t failures_in_row{0};
    TimePoint retry_at{TimePoint::min()};
    TimePoint attempt_ends_at{no_deadline};
    TimePoint ready_since{};

    /// The result of the last GetEndpoints; none if it must be requested again.
    Array<EndpointDescription> discovered;
    std::optional<EndpointChoice> choice;
    /// The choice was made in an earlier attempt.
    bool is_choice_old{false};
    /// The choice's URL is the one that the server was reached by, as its own did not answer.
    bool is_detour{false};
    /// Redials of this attempt, because the server had no connection left; the next one is at
    /// `redial_at`.
    std::uint32_t redials{0};
    TimePoint redial_at{TimePoint::min()};

    detail::Transport transport;
    std::optional<Connection> connection;
    /// The Subscriptions know of a session and not yet of its loss.
    bool is_session_told{false};
    /// All events of the connection were processed.
    bool is_drained{true};
    /// The session that another connection may resume.
    std::optional<KeptSession> kept_session;

    /// Handles of our own requests; 0: none.
    std::uint32_t endpoints_handle{0};
    std::uint32_t info_handle{0};
    std::uint32_t state_handle{0};
    detail::ServerInfoReader reader;
    ServerInfo info;
    /// With the server's namespace indices.
    binary::TypeRegistry types{standard_types()};
    detail::KeepAlive keep_alive;

    /// Reported in the order of the requests; at most one is under way.
    std::deque<PendingUserChange> user_changes;

    detail::RequestQueue requests;
    Subscriptions subscriptions;
};

} // namespace busbar::client
