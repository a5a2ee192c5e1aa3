#include <algorithm>
#include <utility>

#include "login_requests.hpp"
#include "subscriber.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

Subscriber::Subscriber(const SimulationParts& parts, std::size_t number, Habits habits,
                       Chance chance)
    : parts_{parts}, number_{number}, habits_{habits}, chance_{chance}, random_{chance_.next()},
      reconnect_{parts.scheduler, [this] { connect(); }},
      mind_{parts.scheduler, [this] { change_mind(); }}, look_{parts.scheduler, [this] { look(); }},
      slow_{parts.scheduler, [this] { slow_down(); }}, release_{parts.scheduler,
                                                                [this] { speed_up(); }}
{
}

void Subscriber::start()
{
    is_calm_ = false;
    has_left_ = false;
    reconnect_.set_after(chance_.between(0s, 20s));
    mind_.set_after(chance_.between(1min, 10min));
    slow_.set_after(chance_.between(5min, 1h));
    look_.set_after(10s);
}

void Subscriber::calm()
{
    is_calm_ = true;
    mind_.cancel();
    slow_.cancel();
    for (auto& [id, subscription] : subscriptions_) {
        subscription.wants_publishing = true;
    }
    if (reconnect_.is_set()) {
        reconnect_.set_after(1s);
    }
    next_step();
}

void Subscriber::connect()
{
    const auto link =
        std::make_shared<Link>(parts_.scheduler, parts_.weather, Chance{chance_.next(), number_});
    link->set_filter(std::make_unique<LinkWatch>(parts_.weather, held_until_));
    link_ = link;
    channel::ClientChannelConfig config;
    config.endpoint_url = "opc.tcp://localhost:4840";
    config.requested_lifetime = 15min;
    if (habits_.is_secure) {
        config.security = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
        config.server_certificate = server_identity().certificates.front();
    }
    const channel::ChannelEnvironment environment{.random = &random_,
                                                  .wall_clock = &parts_.clock,
                                                  .log = &log_,
                                                  .validator = &validator_,
                                                  .identity = &client_identity()};
    log_.text.clear();
    ClientPort::Owner& owner = *this;
    port_ =
        std::make_unique<ClientPort>(parts_.scheduler, std::move(config), environment, link, owner);
    link->attach(Side::Client, *port_);
    parts_.trace.note(number_, "connects");
    if (!parts_.host.accept(link, "192.0.2." + std::to_string(number_))) {
        if (!parts_.memory.has_failed(parts_.scheduler.now())) {
            violation("no place for a connection");
        }
        return port_->close(false);
    }
    port_->update();
}

void Subscriber::channel_opened()
{
    if (has_session_) {
        activate_session();
    } else {
        create_session();
    }
}

void Subscriber::channel_closed()
{
    parts_.trace.note(number_, "disconnected");
    left_at_ = parts_.scheduler.now();
    // A client that has lost all Subscriptions and wants no new ones says nothing any more.
    const bool was_idle = parts_.scheduler.now() - last_use_ >= session_timeout;
    const bool may_end = was_idle || parts_.memory.has_failed(left_at_ - longest_notice());
    if (is_ready_ && !is_closing_ && !link_->is_cut() && !may_end) {
        violation("the server has ended the connection");
    }
    is_ready_ = false;
    release_.cancel();
    is_busy_ = false;
    if (std::exchange(is_closing_, false)) {
        forget_session(); // whether or not the answer has come
    }
    publish_requests_ = 0;
    orphans_.clear();
    for (auto& [id, subscription] : subscriptions_) {
        for (auto& acknowledgement : subscription.acknowledgements) {
            acknowledgement.is_certain = false;
        }
        for (auto& [handle, watch] : subscription.watches) {
            if (watch.state == Watch::State::Asked) { // under a handle that is not used again
                watch.state = Watch::State::Gone;
            }
        }
    }
    if (!has_left_ && !reconnect_.is_set()) {
        reconnect_.set_after(chance_.between(10ms, 5s));
    }
}

void Subscriber::create_session()
{
    CreateSessionRequest request = session_request(habits_.is_secure);
    request.requested_session_timeout = static_cast<double>(session_timeout.count());
    const TimePoint sent = parts_.scheduler.now();
    port_->call<CreateSessionResponse>(
        request, [this, sent](Result<CreateSessionResponse> response) {
            if (!response && is_refused(response.error(), sent)) {
                return create_session();
            }
            if (!response) {
                return expect(response.error() == status::Bad_ConnectionClosed, "CreateSession",
                              response.error());
            }
            token_ = response->authentication_token;
            server_nonce_ = response->server_nonce;
            has_session_ = true;
            is_nonce_old_ = false;
            was_used_ = false;
            last_use_ = parts_.scheduler.now();
            activate_session();
        });
}

void Subscriber::activate_session()
{
    const crypto::SecurityPolicy& policy = *port_->security().policy;
    const std::string name = "user" + std::to_string(number_);
    ActivateSessionRequest request =
        activation_request(policy, name, name + "-secret", server_nonce_);
    request.request_header.authentication_token = token_;
    const bool was_nonce_old = std::exchange(is_nonce_old_, true);
    const bool may_fail = was_nonce_old || !was_used_;
    const TimePoint sent = parts_.scheduler.now();
    port_->call<ActivateSessionResponse>(
        request, [this, was_nonce_old, may_fail, sent](auto response) {
            if (!response && is_refused(response.error(), sent)) {
                is_nonce_old_ = was_nonce_old;
                return activate_session();
            }
            if (!response) {
                if (response.error() == status::Bad_ConnectionClosed) {
                    return;
                }
                if (!may_fail) {
                    expect(parts_.scheduler.now() - last_use_ >= session_timeout,
                           "a session was lost before its timeout", response.error());
                }
                forget_session();
                return create_session();
            }
            server_nonce_ = response->server_nonce;
            is_nonce_old_ = false;
            become_ready();
        });
}

void Subscriber::forget_session()
{
    parts_.trace.note(number_, "has no session");
    has_session_ = false;
    for (auto& [id, subscription] : subscriptions_) {
        subscription.needs_transfer = true;
    }
}

void Subscriber::session_lost(StatusCode status)
{
    if (is_closing_) {
        return; // the answer to CloseSession is on its way
    }
    expect(!was_used_ || parts_.scheduler.now() - last_use_ >= session_timeout,
           "a session was lost before its timeout", status);
    forget_session();
    is_ready_ = false;
    port_->close(true);
}

void Subscriber::become_ready()
{
    parts_.trace.note(number_, "ready");
    is_ready_ = true;
    undisturbed_since_ = parts_.scheduler.now();
    for (auto& [id, subscription] : subscriptions_) {
        subscription.asks_for_more = habits_.asks_after_return;
        subscription.is_caught_up = false;
    }
    next_step();
}

void Subscriber::go_away(Duration time)
{
    parts_.trace.note(number_, "goes away");
    reconnect_.set_after(time);
    if (port_ != nullptr) {
        port_->close(false);
    }
    if (chance_.one_in(2)) {
        forget_session(); // as a program that starts again with what it knew of its Subscriptions
    }
}

void Subscriber::change_session()
{
    is_closing_ = true;
    CloseSessionRequest request;
    request.delete_subscriptions = false;
    step<CloseSessionResponse>(request, [this](Result<CloseSessionResponse> response) {
        expect(response.has_value(), "CloseSession", response ? StatusCode{} : response.error());
        port_->close(true);
    });
}

void Subscriber::leave()
{
    has_left_ = true;
    reconnect_.cancel();
    look_.cancel();
    if (!is_ready_) {
        if (port_ != nullptr) {
            port_->close(false);
        }
    } else {
        is_closing_ = true;
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        call<CloseSessionResponse>(request, [this](Result<CloseSessionResponse> response) {
            expect(response.has_value(), "CloseSession",
                   response ? StatusCode{} : response.error());
            port_->close(true);
        });
    }
    has_session_ = false;
    subscriptions_.clear();
}

void Subscriber::transfer()
{
    TransferSubscriptionsRequest request;
    request.send_initial_values = chance_.one_in(2);
    for (auto& [id, subscription] : subscriptions_) {
        if (subscription.needs_transfer) {
            request.subscription_ids.push_back(id);
            if (request.send_initial_values) {
                subscription.allow_gaps();
            }
        }
    }
    const auto ids = request.subscription_ids;
    step<TransferSubscriptionsResponse>(
        request, [this, ids](Result<TransferSubscriptionsResponse> response) {
            expect(response && response->results.size() == ids.size(), "TransferSubscriptions",
                   response ? StatusCode{} : response.error());
            for (std::size_t i = 0; response && i < response->results.size(); ++i) {
                transferred(ids[i], response->results[i]);
            }
        });
    for (const std::uint32_t id : ids) {
        if (WatchedSubscription* const subscription = find(id)) {
            subscription->is_transfer_open = true;
        }
    }
}

void Subscriber::transferred(std::uint32_t id, const TransferResult& result)
{
    WatchedSubscription* const subscription = find(id);
    if (subscription == nullptr || is_subscription_lost(id, result.status_code) ||
        is_refused(result.status_code)) {
        return;
    }
    expect(result.status_code == status::Good || result.status_code == status::Bad_NothingToDo,
           "a Subscription was not transferred", result.status_code);
    parts_.trace.note(number_, "transferred", id);
    check_lifetime(*subscription);
    subscription->sequence.receive_available(result.available_sequence_numbers);
    subscription->needs_transfer = false;
    subscription->is_transfer_open = false;
    subscription->undisturbed_since = parts_.scheduler.now();
    subscription->last_use = std::max(subscription->last_use, last_use_);
}

} // namespace busbar::test
