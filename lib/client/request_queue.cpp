#include "request_queue.hpp"

#include <busbar/core/detail/guarded.hpp>

#include "pending_requests.hpp"

namespace busbar::client::detail {

RequestId RequestQueue::add(Encode encode, Handler handler, const RequestOptions& options,
                            bool is_ready, bool is_closed)
{
    const RequestId id = ++last_id_;
    const bool is_full = requests_.size() - finished_.size() >= limit_;
    Request request;
    request.encode = std::move(encode);
    request.handler = std::move(handler);
    request.timeout = options.timeout > Duration::zero() ? options.timeout : default_timeout_;
    request.waits_for_session = options.waits_for_session;
    const auto added = requests_.emplace(id, std::move(request)).first;
    if (is_full) {
        finish(added, fail(status::Bad_TooManyOperations));
    } else if (is_closed || (!is_ready && !options.waits_for_session)) {
        finish(added, fail(status::Bad_ServerNotConnected));
    } else {
        waiting_.insert(id);
        untimed_.push_back(id);
    }
    return id;
}

std::optional<std::uint32_t> RequestQueue::cancel(RequestId id)
{
    const auto found = requests_.find(id);
    if (found == requests_.end()) {
        return std::nullopt;
    }
    const std::uint32_t handle = found->second.handle;
    finish(found, fail(status::Bad_RequestCancelledByClient));
    std::erase(finished_, id);
    requests_.erase(found);
    return handle != 0 ? std::optional{handle} : std::nullopt;
}

void RequestQueue::tell(TimePoint now)
{
    for (const RequestId id : std::exchange(untimed_, {})) {
        const auto found = requests_.find(id);
        if (found != requests_.end() && !found->second.result) {
            found->second.deadline = deadline_after(now, found->second.timeout);
            by_deadline_.insert({found->second.deadline, id});
        }
    }
}

TimePoint RequestQueue::next_deadline() const
{
    if (!untimed_.empty()) {
        return TimePoint::min();
    }
    return by_deadline_.empty() ? no_deadline : by_deadline_.begin()->first;
}

bool RequestQueue::expire(TimePoint now)
{
    if (by_deadline_.empty() || by_deadline_.begin()->first > now) {
        return false;
    }
    finish(requests_.find(by_deadline_.begin()->second), fail(status::Bad_Timeout));
    return true;
}

bool RequestQueue::send_one(Connection& connection, TimePoint now)
{
    if (waiting_.empty()) {
        return false;
    }
    const auto request = requests_.find(*waiting_.begin());
    Request& sent = request->second;
    const auto handle = connection.send_encoded(
        [&](binary::Writer& writer, const RequestHeader& header) { sent.encode(writer, header); },
        sent.deadline == no_deadline ? sent.timeout : sent.deadline - now);
    if (!handle) {
        finish(request, fail(handle.error()));
        return true;
    }
    sent.handle = *handle;
    sent.encode = nullptr;
    by_handle_[*handle] = request->first;
    waiting_.erase(request->first);
    return true;
}

void RequestQueue::answer(std::uint32_t handle, Result<ResponseBody> result)
{
    const auto found = by_handle_.find(handle);
    if (found != by_handle_.end()) {
        finish(requests_.find(found->second), std::move(result));
    }
}

void RequestQueue::end(StatusCode status, bool is_closed)
{
    for (auto request = requests_.begin(); request != requests_.end(); ++request) {
        const bool can_wait = request->second.handle == 0 && request->second.waits_for_session;
        if (!request->second.result && (is_closed || !can_wait)) {
            finish(request, fail(status));
        }
    }
}

bool RequestQueue::deliver(LogSink& log)
{
    if (finished_.empty()) {
        return false;
    }
    auto request = requests_.extract(finished_.front());
    finished_.pop_front();
    busbar::detail::guarded(log, "response handler",
                            [&] { request.mapped().handler(*std::move(request.mapped().result)); });
    return true;
}

void RequestQueue::finish(Requests::iterator request, Result<ResponseBody> result)
{
    if (request->second.result) {
        return;
    }
    by_deadline_.erase({request->second.deadline, request->first});
    waiting_.erase(request->first);
    if (request->second.handle != 0) {
        by_handle_.erase(request->second.handle);
    }
    request->second.handle = 0;
    request->second.encode = nullptr;
    request->second.result = std::move(result);
    finished_.push_back(request->first);
}

} // namespace busbar::client::detail
