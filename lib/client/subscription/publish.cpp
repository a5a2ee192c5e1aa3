#include <algorithm>

#include "engine.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::size_t max_acknowledgements = 1'000; // in one request
constexpr std::size_t max_kept = 100;               // messages that wait for an earlier one
constexpr Duration answer_reserve = std::chrono::seconds{10};

} // namespace

std::size_t SubscriptionEngine::wanted_publishes() const
{
    std::size_t live = 0;
    std::size_t kept = 0;
    for (const auto& [handle, subscription] : subscriptions_) {
        const bool is_live = subscription.phase == Phase::Live;
        if (subscription.phase == Phase::Transferring || (is_live && subscription.is_catching_up)) {
            return 0; // its messages come first
        }
        live += is_live ? 1 : 0;
        kept += subscription.sequence.kept_count();
    }
    if (live == 0 || kept > max_kept) {
        return 0; // what waits for a Republish may not grow for ever
    }
    // Part 4, 5.14.5: with one more than Subscriptions each of them can answer at any time.
    return std::min(std::max<std::size_t>(live + 1, 2), max_publishes_);
}

std::size_t SubscriptionEngine::awaited_publishes() const
{
    return static_cast<std::size_t>(
        std::count_if(publishes_.begin(), publishes_.end(),
                      [](const auto& entry) { return !entry.second.is_overdue; }));
}

Duration SubscriptionEngine::publish_timeout() const
{
    // Requests are answered in their order, the last one after as many keep-alive messages.
    Duration longest{0};
    for (const auto& [handle, subscription] : subscriptions_) {
        if (subscription.phase == Phase::Live) {
            longest = std::max(longest, subscription.keep_alive_interval);
        }
    }
    return longest * static_cast<Duration::rep>(publishes_.size() + 2) + answer_reserve;
}

void SubscriptionEngine::publish()
{
    if (!has_session_ || requester_.now() < publish_at_) {
        return;
    }
    for (std::size_t wanted = wanted_publishes(); awaited_publishes() < wanted;) {
        send_publish();
    }
}

void SubscriptionEngine::send_publish()
{
    const std::size_t count = std::min(acknowledgements_.size(), max_acknowledgements);
    const auto end = acknowledgements_.begin() + static_cast<std::ptrdiff_t>(count);
    Publish entry;
    entry.acknowledgements.assign(acknowledgements_.begin(), end);
    acknowledgements_.erase(acknowledgements_.begin(), end);
    PublishRequest request;
    request.subscription_acknowledgements = entry.acknowledgements;
    const std::uint64_t token = ++last_publish_;
    entry.token = send<PublishResponse>(
        std::move(request),
        [this, token](Result<PublishResponse> response) { published(token, std::move(response)); },
        publish_timeout());
    publishes_.emplace(token, std::move(entry));
}

void SubscriptionEngine::published(std::uint64_t token, Result<PublishResponse> response)
{
    const auto found = publishes_.find(token);
    if (found == publishes_.end()) {
        return;
    }
    auto acknowledged = std::move(found->second.acknowledgements);
    publishes_.erase(found);
    if (!response) {
        take_back(std::move(acknowledged));
        publish_failed(response.error());
        return;
    }
    // What is unknown now needs no acknowledgement; only a Subscription that is gone matters.
    const std::size_t count = std::min(acknowledged.size(), response->results.size());
    for (std::size_t i = 0; i < count; ++i) {
        const auto gone = by_server_id_.find(acknowledged[i].subscription_id);
        if (response->results[i] == status::Bad_SubscriptionIdInvalid &&
            gone != by_server_id_.end() && find(gone->second)->phase == Phase::Live) {
            lost(*find(gone->second), status::Bad_SubscriptionIdInvalid, false);
        }
    }
    receive(*std::move(response));
}

void SubscriptionEngine::publish_failed(StatusCode status)
{
    if (status == status::Bad_TooManyPublishRequests) {
        // Part 4, 5.14.5.3: wait for a response before the next request.
        const std::size_t awaited = awaited_publishes();
        max_publishes_ = std::max<std::size_t>(awaited, 1);
        publish_at_ = awaited == 0 ? requester_.now() + pause_after_failure : publish_at_;
        return;
    }
    if (status == status::Bad_Timeout) {
        return; // another one goes out
    }
    publish_at_ = requester_.now() + pause_after_failure;
    if (status == status::Bad_NoSubscription) {
        // Republish tells which of them are gone.
        for_each([this](WatchedSubscription& subscription) {
            subscription.is_probing = subscription.phase == Phase::Live;
            fetch_missing(subscription);
        });
    }
}

void SubscriptionEngine::take_back(Array<SubscriptionAcknowledgement> acknowledgements)
{
    for (const auto& acknowledgement : acknowledgements) {
        if (by_server_id_.count(acknowledgement.subscription_id) != 0) {
            acknowledgements_.push_back(acknowledgement);
        }
    }
}

void SubscriptionEngine::forget_acknowledgements(std::uint32_t server_id)
{
    std::erase_if(acknowledgements_, [&](const SubscriptionAcknowledgement& acknowledgement) {
        return acknowledgement.subscription_id == server_id;
    });
}

void SubscriptionEngine::acknowledge(std::uint32_t server_id, std::uint32_t sequence_number)
{
    acknowledgements_.push_back({server_id, sequence_number});
}

/// The server may have forgotten the requests that wait there: as many go out beside them. If it
/// has not, it answers the old ones first (Part 4, 5.14.1.2), and a message in such an answer is as
/// good as any. They end with their timeout at the latest, and until then no more are made.
void SubscriptionEngine::renew_publishes()
{
    if (awaited_publishes() < publishes_.size()) {
        return;
    }
    for (auto& [token, entry] : publishes_) {
        entry.is_overdue = true;
        take_back(std::exchange(entry.acknowledgements, {}));
    }
}

} // namespace busbar::client::detail
