#include <algorithm>
#include <utility>

#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "subscriber.hpp"

namespace busbar::test {

/// Of what one of its Subscriptions brings.
class Subscriber::Judge final : public DeliveryJudge {
public:
    Judge(Subscriber& client, std::uint32_t subscription)
        : client_{client}, subscription_{subscription}
    {
    }
    [[nodiscard]] TimePoint now() const override { return client_.parts_.scheduler.now(); }
    [[nodiscard]] bool may_miss(const Watch& watch, std::int64_t number) const override
    {
        return client_.may_miss(watch, number);
    }
    void violation(const std::string& what) override
    {
        client_.violation("subscription " + std::to_string(subscription_) + ", " + what);
    }

private:
    Subscriber& client_;
    std::uint32_t subscription_;
};

void Subscriber::fill_publish_queue()
{
    const bool has_any =
        std::any_of(subscriptions_.begin(), subscriptions_.end(),
                    [](const auto& entry) { return !entry.second.needs_transfer; });
    while (is_ready_ && !is_closing_ && has_any && publish_requests_ < habits_.publish_requests) {
        ++publish_requests_;
        publish();
    }
}

std::vector<Subscriber::Acknowledged> Subscriber::take_acknowledgements()
{
    using enum Habits::Acknowledging;
    std::vector<Acknowledged> taken;
    for (auto& [id, subscription] : subscriptions_) {
        auto& waiting = subscription.acknowledgements;
        if (habits_.acknowledging == Never) {
            waiting.clear();
        }
        if (habits_.acknowledging == Late && waiting.size() < 4) {
            continue;
        }
        for (const auto& one : std::exchange(waiting, {})) {
            taken.push_back({id, one.number, one.is_certain});
        }
        if (habits_.acknowledging == Wrongly && chance_.one_in(2)) {
            // Numbers that will not be sent in this simulation.
            const auto number = static_cast<std::uint32_t>(1'000'000'000U + chance_.below(1'000));
            taken.push_back({id, number, false});
        }
    }
    return taken;
}

void Subscriber::publish()
{
    PublishRequest request;
    auto acknowledged = take_acknowledgements();
    for (const Acknowledged& one : acknowledged) {
        request.subscription_acknowledgements.push_back({one.subscription_id, one.number});
    }
    const TimePoint sent = parts_.scheduler.now();
    call<PublishResponse>(request, [this, sent, acknowledged = std::move(acknowledged)](
                                       Result<PublishResponse> response) {
        published(std::move(response), sent, acknowledged);
    });
}

void Subscriber::publish_failed(StatusCode status, const std::vector<Acknowledged>& acknowledged)
{
    for (const Acknowledged& one : acknowledged) {
        WatchedSubscription* const subscription = find(one.subscription_id);
        if (subscription != nullptr && one.number < 1'000'000'000U) {
            subscription->acknowledgements.push_back({one.number, false});
        }
    }
    if (status == status::Bad_ConnectionClosed) {
        return;
    }
    if (status == status::Bad_OutOfMemory) {
        // A message may have been made for it, of which the next one, or a keep-alive, tells.
        for (auto& [id, subscription] : subscriptions_) {
            subscription.is_caught_up = false;
        }
        return next_step();
    }
    expect(status == status::Bad_NoSubscription, "Publish", status);
    std::vector<std::uint32_t> ids;
    for (const auto& [id, subscription] : subscriptions_) {
        if (!subscription.needs_transfer) {
            ids.push_back(id);
        }
    }
    // The StatusChangeNotification, which cannot be asked for again, was under way when a
    // connection was lost.
    std::for_each(ids.begin(), ids.end(), [this](std::uint32_t id) { subscription_lost(id); });
    next_step();
}

void Subscriber::published(Result<PublishResponse> response, TimePoint sent,
                           const std::vector<Acknowledged>& acknowledged)
{
    publish_requests_ -= publish_requests_ != 0 ? 1 : 0;
    if (!response) {
        return publish_failed(response.error(), acknowledged);
    }
    const std::uint32_t id = response->subscription_id;
    const NotificationMessage& message = response->notification_message;
    parts_.trace.note(number_, "published", id, message.sequence_number);
    const bool is_status_change =
        message.notification_data.size() == 1 &&
        message.notification_data[0].get_if<StatusChangeNotification>() != nullptr;
    if (WatchedSubscription* const subscription = find(id); subscription == nullptr) {
        if (!is_status_change) {
            delete_subscription(id);
        }
    } else if (is_status_change) {
        subscription_lost(id);
    } else {
        subscription->last_use = std::max(subscription->last_use, sent);
        subscription->heard(parts_.scheduler.now());
        receive(*subscription, *response);
    }
    check_acknowledgements(response->results, acknowledged);
    next_step();
}

void Subscriber::receive(WatchedSubscription& subscription, const PublishResponse& response)
{
    const NotificationMessage& message = response.notification_message;
    const std::uint32_t number = message.sequence_number;
    const std::uint32_t next = subscription.sequence.next();
    const auto complain = [&](const std::string& what) {
        violation(what + " message " + std::to_string(number) + " of " +
                  std::to_string(subscription.id) + " when " + std::to_string(next) + " came next");
    };
    if (message.notification_data.empty()) {
        if (!subscription.sequence.receive_keep_alive(number)) {
            complain("keep-alive with the number of");
        }
    } else {
        const auto& available = response.available_sequence_numbers;
        if (std::find(available.begin(), available.end(), number) == available.end()) {
            complain("not kept for retransmission:");
        }
        if (!subscription.sequence.receive(message)) {
            complain("a second time:");
        }
    }
    if (!subscription.sequence.was_loss_allowed()) {
        complain("a message was not there that should have been kept, before");
    }
    deliver(subscription);
}

void Subscriber::deliver(WatchedSubscription& subscription)
{
    Judge judge{*this, subscription.id};
    while (const auto message = subscription.sequence.take()) {
        subscription.deliver(*message, judge);
        subscription.acknowledgements.push_back({message->sequence_number, true});
    }
}

void Subscriber::check_acknowledgements(const Array<StatusCode>& results,
                                        const std::vector<Acknowledged>& acknowledged)
{
    if (results.size() != acknowledged.size()) {
        return violation("not as many results as acknowledgements");
    }
    const auto kept = static_cast<std::uint32_t>(
        parts_.host.server().config().limits.subscriptions.max_retransmission_messages);
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Acknowledged& one = acknowledged[i];
        const WatchedSubscription* const subscription = find(one.subscription_id);
        if (subscription == nullptr || is_subscription_lost(one.subscription_id, results[i])) {
            continue;
        }
        if (one.number >= 1'000'000'000U) {
            expect(results[i] == status::Bad_SequenceNumberUnknown,
                   "an acknowledgement of what was never sent", results[i]);
        } else if (one.is_certain && one.number + kept > subscription->sequence.highest()) {
            expect(results[i] == status::Good, "acknowledgement of " + std::to_string(one.number),
                   results[i]);
        }
    }
}

bool Subscriber::republish()
{
    for (auto& [id, subscription] : subscriptions_) {
        const bool has_gap = subscription.sequence.has_gap();
        if (!has_gap && !subscription.asks_for_more) {
            continue;
        }
        RepublishRequest request;
        request.subscription_id = id;
        request.retransmit_sequence_number = subscription.sequence.next();
        const std::uint32_t number = request.retransmit_sequence_number;
        step<RepublishResponse>(
            request, [this, id = id, has_gap, number](Result<RepublishResponse> response) {
                republished(id, has_gap, number, response);
            });
        return true;
    }
    return false;
}

void Subscriber::republished(std::uint32_t id, bool had_gap, std::uint32_t number,
                             const Result<RepublishResponse>& response)
{
    WatchedSubscription* const subscription = find(id);
    if (subscription == nullptr || (!response && is_subscription_lost(id, response.error()))) {
        return;
    }
    subscription->undisturbed_since = parts_.scheduler.now();
    if (response) {
        parts_.trace.note(number_, "republished", id, number);
        if (response->notification_message.sequence_number != number) {
            violation("Republish brought another message");
        }
        // It may have come by itself meanwhile.
        static_cast<void>(subscription->sequence.receive(response->notification_message));
        return deliver(*subscription);
    }
    expect(response.error() == status::Bad_MessageNotAvailable, "Republish", response.error());
    subscription->asks_for_more = false;
    if (had_gap && subscription->sequence.next() == number) {
        parts_.trace.note(number_, "lost for good", id, number);
        subscription->sequence.give_up();
        subscription->allow_gaps();
        subscription->needs_values = true;
        deliver(*subscription);
    }
}

void Subscriber::resend(WatchedSubscription& subscription)
{
    subscription.allow_repeats(); // whether or not the answer arrives
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::Server};
    request.methods_to_call[0].method_id = NodeId{0, id::Server_ResendData};
    request.methods_to_call[0].input_arguments.push_back(Variant{subscription.id});
    step<CallResponse>(request, [this, id = subscription.id](const auto& response) {
        WatchedSubscription* const found = find(id);
        const StatusCode status = response ? response->results[0].status_code : response.error();
        if (found != nullptr && !is_subscription_lost(id, status) && !is_refused(status)) {
            expect(status == status::Good, "ResendData", status);
            found->needs_values = false;
            found->undisturbed_since = parts_.scheduler.now();
        }
    });
}

} // namespace busbar::test
