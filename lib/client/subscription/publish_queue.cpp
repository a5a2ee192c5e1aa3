#include "publish_queue.hpp"

#include <algorithm>
#include <utility>

namespace busbar::client::detail {

namespace {

constexpr std::size_t max_acknowledgements = 1'000; // in one request
constexpr std::size_t max_waiting_acknowledgements = 10'000;

} // namespace

PublishQueue::PublishQueue(std::size_t max_requests)
    : configured_{std::max<std::size_t>(max_requests, 1)}, limit_{configured_}
{
}

void PublishQueue::begin_session()
{
    limit_ = configured_;
}

void PublishQueue::end_session()
{
    for (auto& [number, request] : requests_) {
        take_back(request.acknowledgements);
    }
    requests_.clear();
}

void PublishQueue::clear()
{
    requests_.clear();
    acknowledgements_.clear();
}

std::size_t PublishQueue::awaited() const
{
    return static_cast<std::size_t>(
        std::count_if(requests_.begin(), requests_.end(),
                      [](const auto& entry) { return !entry.second.is_overdue; }));
}

std::size_t PublishQueue::missing(std::size_t wanted) const
{
    const std::size_t most = std::min(wanted, limit_);
    const std::size_t here = awaited();
    return here < most ? most - here : 0;
}

PublishQueue::Outgoing PublishQueue::add()
{
    const std::size_t count = std::min(acknowledgements_.size(), max_acknowledgements);
    const auto end = acknowledgements_.begin() + static_cast<std::ptrdiff_t>(count);
    Outgoing outgoing;
    outgoing.number = ++last_number_;
    outgoing.acknowledgements.assign(acknowledgements_.begin(), end);
    acknowledgements_.erase(acknowledgements_.begin(), end);
    requests_[outgoing.number].acknowledgements = outgoing.acknowledgements;
    return outgoing;
}

std::optional<PublishQueue::Acknowledgements> PublishQueue::answered(std::uint64_t number)
{
    const auto found = requests_.find(number);
    if (found == requests_.end()) {
        return std::nullopt;
    }
    std::optional<Acknowledgements> acknowledged{std::move(found->second.acknowledgements)};
    requests_.erase(found);
    return acknowledged;
}

bool PublishQueue::failed(std::uint64_t number)
{
    auto acknowledgements = answered(number);
    if (!acknowledgements) {
        return false;
    }
    take_back(*acknowledgements);
    return true;
}

bool PublishQueue::refuse()
{
    const std::size_t count = awaited();
    limit_ = std::max<std::size_t>(count, 1);
    return count != 0;
}

void PublishQueue::renew()
{
    if (awaited() < requests_.size()) {
        return;
    }
    for (auto& [number, request] : requests_) {
        request.is_overdue = true;
        take_back(request.acknowledgements);
    }
}

void PublishQueue::acknowledge(std::uint32_t subscription_id, std::uint32_t sequence_number)
{
    keep({subscription_id, sequence_number});
}

void PublishQueue::keep(const SubscriptionAcknowledgement& acknowledgement)
{
    // If a server answers only Republish, they would grow for ever. A server that never gets an
    // acknowledgement keeps the message, until it has too many.
    if (acknowledgements_.size() == max_waiting_acknowledgements) {
        acknowledgements_.pop_front();
    }
    acknowledgements_.push_back(acknowledgement);
}

void PublishQueue::forget(std::uint32_t subscription_id)
{
    std::erase_if(acknowledgements_, [&](const SubscriptionAcknowledgement& acknowledgement) {
        return acknowledgement.subscription_id == subscription_id;
    });
    // Their places identify the results in the answer.
    for (auto& [number, request] : requests_) {
        for (SubscriptionAcknowledgement& acknowledgement : request.acknowledgements) {
            if (acknowledgement.subscription_id == subscription_id) {
                acknowledgement.subscription_id = 0;
            }
        }
    }
}

void PublishQueue::take_back(Acknowledgements& acknowledgements)
{
    for (const SubscriptionAcknowledgement& acknowledgement : acknowledgements) {
        if (acknowledgement.subscription_id != 0) {
            keep(acknowledgement);
        }
    }
    acknowledgements = {};
}

} // namespace busbar::client::detail
