#include "request_queue.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

bool is_unanswered(StatusCode status)
{
    return status == status::Bad_Timeout || status == status::Bad_ConnectionClosed ||
           status == status::Bad_SecureChannelClosed || status == status::Bad_ServerNotConnected ||
           status == status::Bad_OutOfMemory;
}

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
    ++waiting_count_;
    busbar::detail::Undo undo{[&] {
        requests_.erase(added);
        --waiting_count_;
    }};
    if (is_full) {
        finish(added, fail(status::Bad_TooManyOperations));
    } else if (is_closed || (!is_ready && !options.waits_for_session)) {
        finish(added, fail(status::Bad_ServerNotConnected));
    }
    undo.keep();
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
    for (auto at = requests_.upper_bound(timed_until_); at != requests_.end(); ++at) {
        if (at->second.is_waiting()) {
            at->second.deadline = deadline_after(now, at->second.timeout);
            deadlines_.add(at->second.deadline, at->first);
        }
    }
    timed_until_ = last_id_;
}

TimePoint RequestQueue::next_deadline() const
{
    return timed_until_ != last_id_ ? TimePoint::min() : deadlines_.next_deadline();
}

bool RequestQueue::expire(TimePoint now)
{
    if (deadlines_.next_deadline() > now || deadlines_.size() == 0) {
        return false;
    }
    finish(requests_.find(deadlines_.first()), fail(status::Bad_Timeout));
    return true;
}

bool RequestQueue::send_one(Connection& connection, TimePoint now)
{
    if (!has_waiting()) {
        return false;
    }
    const auto request = std::find_if(requests_.lower_bound(next_waiting_), requests_.end(),
                                      [](const auto& entry) { return entry.second.is_waiting(); });
    next_waiting_ = request->first; // if this throws, the request still waits
    Request& sent = request->second;
    if (sent.deadline <= now) {
        finish(request, fail(status::Bad_Timeout));
        return true;
    }
    Result<std::uint32_t> handle = 0;
    const StatusCode thrown = busbar::detail::caught([&] {
        handle = connection.send_encoded(
            [&](binary::Writer& writer, const RequestHeader& header) {
                sent.encode(writer, header);
            },
            sent.deadline == no_deadline ? sent.timeout : sent.deadline - now, request->first);
    });
    if (thrown.is_bad() || !handle) { // it may have been sent, and must not be sent again
        finish(request, fail(thrown.is_bad() ? thrown : handle.error()));
        return true;
    }
    sent.handle = *handle;
    sent.encode = nullptr;
    leave();
    return true;
}

void RequestQueue::answer(RequestId id, Result<ResponseBody> result)
{
    const auto found = requests_.find(id);
    if (found != requests_.end() && found->second.handle != 0) {
        finish(found, std::move(result));
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
    finished_.push_back(request->first); // first, as it may fail
    const bool was_waiting = request->second.handle == 0;
    request->second.handle = 0;
    request->second.encode = nullptr;
    request->second.result = std::move(result);
    if (was_waiting) {
        leave();
    }
}

void RequestQueue::leave()
{
    --waiting_count_;
    deadlines_.prune(waiting_count_, [this](TimePoint, RequestId id) {
        const auto found = requests_.find(id);
        return found != requests_.end() && found->second.is_waiting();
    });
}

} // namespace busbar::client::detail
