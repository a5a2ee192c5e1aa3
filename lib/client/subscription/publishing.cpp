#include "publishing.hpp"

#include <algorithm>

namespace busbar::client::detail {

namespace {

constexpr std::size_t max_kept = 100; // messages that wait for an earlier one
constexpr Duration answer_reserve = std::chrono::seconds{10};
constexpr Duration pause_after_failure = std::chrono::seconds{1};

} // namespace

Publishing::Publishing(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
                       PublishQueue& queue, Reception& reception)
    : requests_{requests}, subscriptions_{subscriptions}, ends_{ends}, queue_{queue}, reception_{
                                                                                          reception}
{
}

void Publishing::begin_session()
{
    queue_.begin_session();
    publish_at_ = {};
}

TimePoint Publishing::next_deadline(TimePoint handled_until) const
{
    return publish_at_ > handled_until ? publish_at_ : no_deadline;
}

void Publishing::publish()
{
    if (!requests_.has_session() || requests_.now() < publish_at_) {
        return;
    }
    for (std::size_t count = queue_.missing(wanted()); count > 0; --count) {
        send_one();
    }
}

std::size_t Publishing::wanted() const
{
    std::size_t live = 0;
    std::size_t kept = 0;
    for (const auto& [handle, subscription] : subscriptions_.all()) {
        const bool is_live = subscription.phase == Phase::Live;
        if (subscription.phase == Phase::Transferring ||
            (is_live && subscription.messages.is_catching_up)) {
            return 0; // its messages have precedence
        }
        live += is_live ? 1 : 0;
        kept += subscription.messages.sequence.kept_count();
    }
    if (live == 0 || kept > max_kept) {
        return 0; // messages that wait for a Republish must not grow for ever
    }
    // Part 4, 5.14.5: with one more than Subscriptions each of them can answer at any time.
    return std::max<std::size_t>(live + 1, 2);
}

Duration Publishing::timeout() const
{
    // Requests are answered in their order, the last one after as many keep-alive messages.
    Duration longest{0};
    for (const auto& [handle, subscription] : subscriptions_.all()) {
        if (subscription.phase == Phase::Live) {
            longest = std::max(longest, subscription.messages.keep_alive_interval);
        }
    }
    return longest * static_cast<Duration::rep>(queue_.size() + 2) + answer_reserve;
}

void Publishing::send_one()
{
    const Duration longest = timeout();
    auto outgoing = queue_.add();
    PublishRequest request;
    request.subscription_acknowledgements = std::move(outgoing.acknowledgements);
    requests_.send<PublishResponse>(
        std::move(request),
        [this, number = outgoing.number](Result<PublishResponse> response) {
            if (response) {
                answered(number, *std::move(response));
            } else if (queue_.failed(number)) {
                failed(response.error());
            }
        },
        longest);
}

void Publishing::answered(std::uint64_t number, PublishResponse response)
{
    const auto acknowledged = queue_.answered(number);
    if (!acknowledged) {
        return;
    }
    // An unknown message needs no acknowledgement; only a missing Subscription matters.
    const std::size_t count = std::min(acknowledged->size(), response.results.size());
    for (std::size_t i = 0; i < count; ++i) {
        if (response.results[i] != status::Bad_SubscriptionIdInvalid) {
            continue;
        }
        WatchedSubscription* gone =
            subscriptions_.find_at_server((*acknowledged)[i].subscription_id);
        if (gone != nullptr && gone->phase == Phase::Live) {
            ends_.lost(*gone, status::Bad_SubscriptionIdInvalid, false);
        }
    }
    reception_.receive(std::move(response));
}

void Publishing::failed(StatusCode status)
{
    if (status == status::Bad_TooManyPublishRequests) {
        // Part 4, 5.14.5.3: wait for a response before the next request.
        if (!queue_.refuse()) {
            publish_at_ = requests_.now() + pause_after_failure;
        }
        return;
    }
    if (status == status::Bad_Timeout) {
        return; // another one goes out
    }
    publish_at_ = requests_.now() + pause_after_failure;
    subscriptions_.for_each(
        [](WatchedSubscription& subscription) { subscription.messages.has_sign = true; });
    if (status == status::Bad_NoSubscription) {
        reception_.probe_all(); // Republish tells which of them do not exist
    }
}

} // namespace busbar::client::detail
