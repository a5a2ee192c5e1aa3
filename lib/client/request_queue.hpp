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

/// True if no answer of the server came, so that the same request may get one later.
[[nodiscard]] bool is_unanswered(StatusCode status);

/// The requests of a Client's users from call() to their handler: waiting for a session, under way
/// or answered. Every one ends once, by its deadline at the latest; handlers are called by
/// deliver() only.
///
/// While a request is under way the Connection has its deadline, and knows it by its RequestId.
/// Deadlines begin with the first time that is known after call(), which may come from a user who
/// has not told the time for a while.
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
    /// What it is called on the connection, if it is under way there.
    std::optional<std::uint32_t> cancel(RequestId id);

    /// Gives what has no deadline yet its own.
    void tell(TimePoint now);
    [[nodiscard]] TimePoint next_deadline() const;
    /// Ends one waiting request whose deadline has come. False if there is none.
    bool expire(TimePoint now);

    /// Sends the request that has waited longest. False if none waits.
    bool send_one(Connection& connection, TimePoint now);
    [[nodiscard]] bool has_waiting() const { return waiting_count_ != 0; }
    /// Takes the response to a request that is under way.
    void answer(RequestId id, Result<ResponseBody> result);
    /// The connection is gone: what was under way ends with `status`, and so does what does not
    /// want to wait, or all of it.
    void end(StatusCode status, bool is_closed);

    /// Calls one handler; what it throws `log` is told. False if there is nothing to deliver.
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
    /// It waits no longer.
    void leave();

    std::size_t limit_;
    Duration default_timeout_;
    RequestId last_id_{0};
    /// Handlers may add and remove others: references into it stay valid.
    Requests requests_;
    std::size_t waiting_count_{0};
    RequestId next_waiting_{0};         // none before it waits
    RequestId timed_until_{0};          // those after it have no deadline yet
    DeadlineHeap<RequestId> deadlines_; // of those that wait
    std::deque<RequestId> finished_;
};

} // namespace busbar::client::detail
