#include "publish_queue.hpp"

#include <algorithm>
#include <utility>

#include "subscription.hpp"

namespace busbar::server::detail {

PublishPart& PublishPart::of(Session& session)
{
    if (session.publishing == nullptr) {
        session.publishing = std::make_unique<PublishPart>();
    }
    return static_cast<PublishPart&>(*session.publishing);
}

PublishPart::~PublishPart()
{
    for (PublishOperation* request : requests_) {
        request->part_ = nullptr;
    }
}

void PublishPart::remove(Subscription& subscription)
{
    std::erase(subscriptions_, &subscription);
    serve_status_changes();
    if (subscriptions_.empty() && status_changes_.empty()) {
        while (PublishOperation* const request = take_request()) {
            request->refuse(status::Bad_NoSubscription); // DeleteClientPublReqQueue()
        }
    }
}

void PublishPart::add_status_change(std::size_t most, StatusChange change)
{
    if (status_changes_.size() >= most) {
        status_changes_.erase(status_changes_.begin());
    }
    status_changes_.push_back(std::move(change));
    serve_status_changes();
}

void PublishPart::serve_status_changes()
{
    while (!status_changes_.empty() && next_request() != nullptr) {
        const StatusChange change = std::move(status_changes_.front());
        status_changes_.erase(status_changes_.begin());
        take_request()->answer_status_change(change.subscription_id, change.message);
    }
}

void PublishPart::forget_finished()
{
    std::erase_if(requests_, [](PublishOperation* request) {
        if (request->is_finished()) {
            request->part_ = nullptr;
        }
        return request->part_ == nullptr;
    });
}

void PublishPart::enqueue(PublishOperation& request, std::size_t most)
{
    forget_finished();
    while (requests_.size() >= most && !requests_.empty()) {
        take_request()->refuse(status::Bad_TooManyPublishRequests);
    }
    request.part_ = this;
    requests_.push_back(&request);
}

std::size_t PublishPart::waiting() const
{
    return static_cast<std::size_t>(
        std::count_if(requests_.begin(), requests_.end(),
                      [](const PublishOperation* request) { return !request->is_finished(); }));
}

void PublishPart::refuse_overdue(TimePoint now)
{
    for (PublishOperation* request : requests_) {
        if (!request->is_finished() && request->is_overdue(now)) {
            request->refuse(status::Bad_Timeout);
        }
    }
}

void PublishPart::refuse_others(const Peer& peer)
{
    for (PublishOperation* request : requests_) {
        if (!request->is_finished() && !request->is_of(peer)) {
            request->refuse(status::Bad_SecureChannelClosed);
        }
    }
}

PublishOperation* PublishPart::next_request()
{
    while (!requests_.empty() && requests_.front()->is_finished()) {
        requests_.front()->part_ = nullptr;
        requests_.erase(requests_.begin());
    }
    return requests_.empty() ? nullptr : requests_.front();
}

PublishOperation* PublishPart::take_request()
{
    PublishOperation* const request = next_request();
    if (request != nullptr) {
        requests_.erase(requests_.begin());
        request->part_ = nullptr;
    }
    return request;
}

Subscription* PublishPart::next_subscription() const
{
    Subscription* next = nullptr;
    for (Subscription* candidate : subscriptions_) {
        if (!candidate->wants_publish_request()) {
            continue;
        }
        const auto order = [](const Subscription& s) {
            return std::pair{-static_cast<int>(s.parameters().priority), s.last_served()};
        };
        if (next == nullptr || order(*candidate) < order(*next)) {
            next = candidate;
        }
    }
    return next;
}

void PublishPart::serve(TimePoint now)
{
    refuse_overdue(now);
    serve_status_changes();
    while (next_request() != nullptr) {
        Subscription* const subscription = next_subscription();
        if (subscription == nullptr) {
            return;
        }
        subscription->handle(SubscriptionEvent::PublishRequest, {.now = now});
    }
}

} // namespace busbar::server::detail
