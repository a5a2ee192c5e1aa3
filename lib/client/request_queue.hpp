#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include <busbar/client/connection.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/core/log.hpp>

#include "deadline_heap.hpp"

namespace busbar::client::detail {

/// True if the server has not answered, so that the same request may succeed later.
[[nodiscard]] bool is_unanswered(StatusCode status);

/// The requests of a Client's users from call() to their handler: waiting for a session, under way
/// or answered. Every one ends once, by its deadline at the latest; handlers are called by
/// deliver() only.
///
/// While a request is under way the Connection has its deadline, and knows it by its RequestId.
/// Deadlines begin with the first time that is known after call(), which may come from a user who
/// has not set the time for a while.
class RequestQueue {
public:
    using Encode = std::function<void(binary::Writer&, const RequestHeader&)>;
    using Handler = std::function<void(Result<ResponseBody>)>;

    RequestQueue(std::size_t limit, Duration default_timeout)
        : limit_{limit}, default_timeout_{default_timeout}
    {
    }

    /// `is_ready`: there is a session; `is_closed`: there will be none.
    RequestId add(Encode encode, Handler handler, const RequestOptions& options, bool is_ready,
                  bool is_closed);
    /// Returns its handle on the connection, if it is under way there.
    std::optional<std::uint32_t> cancel(RequestId id);

    /// Sets the deadlines of requests that have none yet.
    void tell(TimePoint now);
    [[nodiscard]] TimePoint next_deadline() const;
    /// Ends one waiting request whose deadline has come. False if there is none.
    bool expire(TimePoint now);

    /// Sends the request that has waited longest. False if none waits.
    bool send_one(Connection& connection, TimePoint now);
    [[nodiscard]] bool has_waiting() const { return waiting_count_ != 0; }
    /// Takes the response of a request that is under way.
    void answer(RequestId id, Result<ResponseBody> result);
    /// The connection is closed: requests under way end with `status`, and so do those that do not
    /// wait for a session, or all of them.
    void end(StatusCode status, bool is_closed);

    /// Calls one handler; its exceptions go to `log`. False if there is nothing to deliver.
    bool deliver(LogSink& log);
    [[nodiscard]] bool has_results() const { return !finished_.empty(); }
    [[nodiscard]] std::size_t size() const { return requests_.size(); }

private:
    struct Request {
        Encode encode;
        Handler handler;
        Duration timeout{0};
        bool waits_for_session{true};
        TimePoint deadline{no_deadline};
        std::uint32_t handle{0}; // on the connection, while it is under way there
        std::optional<Result<ResponseBody>> result;

        [[nodiscard]] bool is_waiting() const { return handle == 0 && !result; }
    };
    using Requests = std::map<RequestId, Request>;

    void finish(Requests::iterator request, Result<ResponseBody> result);
    /// Removes it from the waiting requests.
    void leave();

    std::size_t limit_;
    Duration default_timeout_;
    RequestId last_id_{0};
    /// Handlers may add and remove other requests: references into it stay valid.
    Requests requests_;
    std::size_t waiting_count_{0};
    RequestId next_waiting_{0};         // 0 if none waits
    RequestId timed_until_{0};          // those after it have no deadline yet
    DeadlineHeap<RequestId> deadlines_; // of waiting requests
    std::deque<RequestId> finished_;
};

} // namespace busbar::client::detail
