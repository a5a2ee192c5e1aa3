#include "call_turns.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::administration::detail {

bool CallTurns::wake()
{
    if (waker_ == nullptr) {
        return false;
    }
    busbar::detail::attempt([this] { waker_->wake(); });
    return true;
}

void CallTurns::serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)
{
    const StatusCode thrown =
        busbar::detail::guarded(*log_, "a Method of administration", [&] { serve_(batch, index); });
    // This is the answer if serve_ gave none.
    StatusCode& answer = batch->results()[index].status;
    if (thrown.is_bad() && answer == status::Bad_InternalError) {
        answer = thrown;
    }
}

CallTurns::Line* CallTurns::find(const Holder& holder)
{
    const auto found = std::find_if(lines_.begin(), lines_.end(),
                                    [&](const Line& line) { return line.holder == holder; });
    return found == lines_.end() ? nullptr : &*found;
}

void CallTurns::add(server::CallBatch batch)
{
    const auto shared = std::make_shared<server::CallBatch>(std::move(batch));
    const Holder holder =
        server_ != nullptr ? holder_of(*server_, shared->caller().session_id) : Holder{};
    if (Line* const line = find(holder); line != nullptr) {
        line->calls.push_back({shared, 0});
        return;
    }
    // Allocate memory before the first Method is called.
    std::list<Line> line;
    if (shared->size() > 1) {
        line.push_back({holder, {}});
        line.back().calls.push_back({shared, 1});
    }
    serve(shared, 0);
    if (line.empty()) {
        return;
    }
    if (server_ != nullptr && wake()) {
        lines_.splice(lines_.end(), line);
        return;
    }
    for (std::size_t next = 1; next < shared->size(); ++next) {
        serve(shared, next);
    }
}

StatusCode CallTurns::check_waiting(const Holder& holder, const server::CallBatch& batch,
                                    std::size_t index) const
{
    if (batch.is_abandoned()) {
        return status::Bad_Timeout;
    }
    const server::CallItem& call = batch.items()[index];
    return check_still(*server_, holder, *call.object_id, *call.method_id);
}

void CallTurns::serve_next()
{
    if (lines_.empty()) {
        return;
    }
    // Update the lines before calling the Method, which may throw.
    Line& line = lines_.front();
    Waiting& first = line.calls.front();
    const Holder holder = line.holder;
    const std::shared_ptr<server::CallBatch> batch = first.batch;
    const std::size_t index = first.next++;
    if (first.next == batch->size()) {
        line.calls.pop_front();
    }
    if (line.calls.empty()) {
        lines_.pop_front();
    } else {
        lines_.splice(lines_.end(), lines_, lines_.begin());
    }
    if (!lines_.empty()) {
        static_cast<void>(wake());
    }
    if (const StatusCode refused = check_waiting(holder, *batch, index); refused.is_bad()) {
        return server::MethodCall{batch, index}.fail(refused);
    }
    serve(batch, index);
}

} // namespace busbar::administration::detail
