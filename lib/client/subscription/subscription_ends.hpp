#pragma once

#include <cstdint>
#include <vector>

#include "publish_queue.hpp"
#include "session_requests.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// The ends of Subscriptions at the server: those that the server no longer has, which are created
/// again, and those that are not needed any more, which are deleted.
class SubscriptionEnds {
public:
    SubscriptionEnds(SessionRequests& requests, WatchList& subscriptions, PublishQueue& publishes);

    void begin_session(bool is_new);
    void end_session();

    /// The user has removed it.
    void remove(WatchedSubscription& subscription);
    /// The server no longer has it, or its state there is unknown: it is created again. Calls a
    /// handler. `may_live`: the server may still have it, and shall delete it then.
    void lost(WatchedSubscription& subscription, StatusCode reason, bool may_live);
    /// Deletes it at the server, if it has it: at most 1,000 wait for that, others end with their
    /// lifetime.
    void doom(std::uint32_t server_id);
    void delete_doomed();

private:
    SessionRequests& requests_;
    WatchList& subscriptions_;
    PublishQueue& publishes_;
    std::vector<std::uint32_t> doomed_;   // to be deleted
    std::vector<std::uint32_t> deleting_; // in the request under way
};

} // namespace busbar::client::detail
