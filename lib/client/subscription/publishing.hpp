#pragma once

#include <busbar/core/clock.hpp>

#include "publish_queue.hpp"
#include "reception.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Keeps Publish requests at the server (Part 4, 5.14.5), and pauses when it refuses them.
class Publishing {
public:
    Publishing(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
               PublishQueue& queue, Reception& reception);

    void begin_session();
    [[nodiscard]] TimePoint next_deadline(TimePoint handled_until) const;
    /// Sends as many requests as are missing.
    void publish();

private:
    [[nodiscard]] std::size_t wanted() const;
    /// The timeout of the next request.
    [[nodiscard]] Duration timeout() const;
    void send_one();
    void answered(std::uint64_t number, PublishResponse response);
    void failed(StatusCode status);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    SubscriptionEnds& ends_;
    PublishQueue& queue_;
    Reception& reception_;
    TimePoint publish_at_{}; // nothing is sent before
};

} // namespace busbar::client::detail
