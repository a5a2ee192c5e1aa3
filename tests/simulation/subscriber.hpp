#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>

#include <busbar/types/session.hpp>

#include "client_port.hpp"
#include "harness_names.hpp"
#include "link_watch.hpp"
#include "memory_weather.hpp"
#include "support/server_fixture.hpp"
#include "trace.hpp"
#include "watched_subscription.hpp"

namespace busbar::test {

/// What all clients of a simulation share.
struct SimulationParts {
    Scheduler& scheduler;
    const WallClock& clock;
    const Weather& weather;
    const MemoryWeather& memory;
    const Plant& plant;
    ServerHost& host;
    Trace& trace;
};

/// How one client behaves, as chance has it.
struct Habits {
    enum class Acknowledging : std::uint8_t { AtOnce, Late, Never, Wrongly };

    Acknowledging acknowledging{Acknowledging::AtOnce};
    /// That it keeps in flight.
    std::size_t publish_requests{2};
    std::size_t subscriptions{1};
    /// Asks for lost messages as soon as it is back, not only when it notices that some are lost.
    bool asks_after_return{false};
    bool is_secure{false};
    /// One of its Subscriptions has more to tell in a storm than the client can take.
    bool is_saturated{false};
};

/// A client that wants to see every change, over a network that does not let it: comes back after
/// resets, re-activates its session or takes its Subscriptions over with a new one, asks for lost
/// messages, and checks what comes. It changes its mind now and then, and goes away without a word.
class Subscriber final : private ClientPort::Owner {
public:
    static constexpr std::chrono::milliseconds session_timeout{15 * 60'000};

    Subscriber(const SimulationParts& parts, std::size_t number, Habits habits, Chance chance);

    void start();
    /// Wants nothing new any more and comes back, if it is away.
    void calm();
    /// Closes its session with its Subscriptions, and goes.
    void leave();
    /// Whether all that was counted has arrived. After calm(), with the plant and network quiet.
    void check_arrivals();

private:
    class Judge;

    // subscriber_session.cpp

    void connect();
    void channel_opened() override;
    void channel_closed() override;
    void create_session();
    void activate_session();
    void forget_session();
    /// The server does not know the session any more, which has to be for its timeout.
    void session_lost(StatusCode status);
    void become_ready();
    void go_away(Duration time);
    void change_session();
    void transfer();
    void transferred(std::uint32_t id, const TransferResult& result);
    /// Sends a request within the session.
    template <typename Response, typename Request>
    void call(Request request, std::function<void(Result<Response>)> then);
    /// The same, with nothing else but Publish meanwhile; `then` is not called if the connection
    /// is lost or the server has no memory for it.
    template <typename Response, typename Request>
    void step(Request request, std::function<void(Result<Response>)> then);

    // subscriber_publish.cpp

    struct Acknowledged {
        std::uint32_t subscription_id;
        std::uint32_t number;
        bool is_certain;
    };
    void fill_publish_queue();
    void publish();
    void published(Result<PublishResponse> response, TimePoint sent,
                   const std::vector<Acknowledged>& acknowledged);
    void publish_failed(StatusCode status, const std::vector<Acknowledged>& acknowledged);
    [[nodiscard]] std::vector<Acknowledged> take_acknowledgements();
    void check_acknowledgements(const Array<StatusCode>& results,
                                const std::vector<Acknowledged>& acknowledged);
    void receive(WatchedSubscription& subscription, const PublishResponse& response);
    void deliver(WatchedSubscription& subscription);
    [[nodiscard]] bool republish();
    void republished(std::uint32_t id, bool had_gap, std::uint32_t number,
                     const Result<RepublishResponse>& response);
    /// Has the server send the values of all items once more (Part 5, 9.1).
    void resend(WatchedSubscription& subscription);

    // subscriber_wishes.cpp

    /// Does the next thing there is to do.
    void next_step();
    [[nodiscard]] bool adjust(WatchedSubscription& subscription);
    [[nodiscard]] bool adjust(WatchedSubscription& subscription, std::uint32_t handle);
    void create_subscription();
    [[nodiscard]] bool create_items(WatchedSubscription& subscription);
    void items_created(std::uint32_t id, const std::vector<std::uint32_t>& handles,
                       const Result<CreateMonitoredItemsResponse>& response);
    void modify_subscription(WatchedSubscription& subscription);
    void set_publishing(WatchedSubscription& subscription);
    void set_mode(WatchedSubscription& subscription, std::uint32_t handle);
    void modify_item(WatchedSubscription& subscription, std::uint32_t handle);
    void delete_item(WatchedSubscription& subscription, std::uint32_t handle);
    void delete_subscription(std::uint32_t id);
    void change_mind();
    void change_item(WatchedSubscription& subscription);
    void wish_for_items(WatchedSubscription& subscription);

    // subscriber_checks.cpp

    [[nodiscard]] WatchedSubscription* find(std::uint32_t id);
    [[nodiscard]] Watch* find(std::uint32_t id, std::uint32_t handle);
    /// The server does not know the Subscription any more, which has to be for its lifetime.
    void subscription_lost(std::uint32_t id);
    /// The server knows the Subscription still, when the client has come back.
    void check_lifetime(const WatchedSubscription& subscription);
    /// True, and handled, if the response says that.
    [[nodiscard]] bool is_subscription_lost(std::uint32_t id, StatusCode status);
    void violation(const std::string& what) { parts_.trace.violation(number_, what); }
    /// True, and noted, if the server had no memory for what was asked for at that time: nothing of
    /// it was done.
    [[nodiscard]] bool is_refused(StatusCode status, TimePoint asked);
    [[nodiscard]] bool is_refused(StatusCode status) { return is_refused(status, step_sent_); }
    /// Without memory a sample was not taken, or an event was lost and the server has told so.
    [[nodiscard]] bool may_miss(const Watch& watch, std::int64_t number) const;
    /// The next event that must come, which may not have been raised yet.
    [[nodiscard]] std::int64_t next_event(const Watch& watch) const;
    /// Items whose creation was refused are wanted still.
    void take_back_items();
    void expect(bool condition, const std::string& what, StatusCode status);

    // subscriber_delays.cpp

    /// Looks whether what has to come takes too long.
    void look();
    [[nodiscard]] bool is_undisturbed() const;
    /// How much later than it happens a client that reads again learns of anything.
    [[nodiscard]] Duration longest_notice() const;
    void check_answer();
    void check_message(const WatchedSubscription& subscription);
    [[nodiscard]] bool may_have_ended(const WatchedSubscription& subscription) const;
    void check_values(const WatchedSubscription& subscription);
    /// How long it may take until all that the Subscription has queued has arrived, once it has
    /// begun to send.
    [[nodiscard]] Duration sending_time(const WatchedSubscription& subscription) const;
    /// The client or its link is slow for a while, or the link seems to be dead.
    void slow_down();
    void speed_up();

    SimulationParts parts_;
    std::size_t number_;
    Habits habits_;
    Chance chance_;
    SeededRandom random_;
    LogBook log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    std::unique_ptr<ClientPort> port_;
    std::shared_ptr<Link> link_;

    // The session.

    NodeId token_;
    ByteString server_nonce_;
    bool has_session_{false};
    /// An ActivateSession has got no answer: the nonce may be an old one.
    bool is_nonce_old_{false};
    bool is_closing_{false};
    bool is_ready_{false};
    bool is_busy_{false};
    bool is_calm_{false};
    bool has_left_{false};
    /// When a request of the session was sent that the server has answered.
    TimePoint last_use_;
    /// When the connection before this one ended.
    TimePoint left_at_;
    bool was_used_{false};
    std::uint32_t last_request_{0};
    /// When the request was sent that is_busy_ waits for.
    TimePoint step_sent_;

    // What keeps things from arriving, by what the simulation itself does.

    /// When the client was ready again, or its link not slow any more.
    TimePoint undisturbed_since_;
    LinkWatch::HeldUntil held_until_{std::make_shared<TimePoint>()};

    // Subscriptions.

    std::size_t publish_requests_{0};
    std::map<std::uint32_t, WatchedSubscription> subscriptions_;
    /// Of which nobody wants to know any more, and which are being deleted.
    std::set<std::uint32_t> orphans_;

    Alarm reconnect_;
    Alarm mind_;
    Alarm look_;
    Alarm slow_;
    Alarm release_;
};

template <typename Response, typename Request>
void Subscriber::call(Request request, std::function<void(Result<Response>)> then)
{
    request.request_header.authentication_token = token_;
    request.request_header.request_handle = ++last_request_;
    const TimePoint sent = parts_.scheduler.now();
    port_->call<Response>(request, [this, sent, then = std::move(then)](Result<Response> response) {
        const StatusCode status = response ? StatusCode{} : response.error();
        if (status == status::Bad_SessionIdInvalid || status == status::Bad_SessionClosed ||
            status == status::Bad_SecureChannelIdInvalid ||
            status == status::Bad_SessionNotActivated) {
            session_lost(status);
            response = fail(status::Bad_ConnectionClosed);
        } else if (status != status::Bad_ConnectionClosed && !is_refused(status, sent)) {
            last_use_ = std::max(last_use_, sent);
            was_used_ = true;
        }
        then(std::move(response));
    });
}

template <typename Response, typename Request>
void Subscriber::step(Request request, std::function<void(Result<Response>)> then)
{
    is_busy_ = true;
    step_sent_ = parts_.scheduler.now();
    call<Response>(std::move(request), [this, then = std::move(then)](Result<Response> response) {
        is_busy_ = false;
        if (!response && response.error() == status::Bad_ConnectionClosed) {
            return;
        }
        if (!response && is_refused(response.error())) {
            take_back_items();
        } else {
            then(std::move(response));
        }
        next_step();
    });
}

} // namespace busbar::test
