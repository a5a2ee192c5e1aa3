#include "call_turns.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::administration::detail {

void CallTurns::attach(server::Waker* waker)
{
    const std::lock_guard lock{mutex_};
    waker_ = waker;
}

bool CallTurns::wake()
{
    const std::lock_guard lock{mutex_};
    if (waker_ == nullptr) {
        return false;
    }
    waker_->wake();
    return true;
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
    std::size_t next = 0;
    if (Line* const line = find(holder); line != nullptr) {
        line->calls.push_back({shared, next});
        return;
    }
    const std::size_t count = shared->size();
    serve_(shared, next++);
    if (next == count) {
        return;
    }
    if (server_ == nullptr || !wake()) {
        while (next < count) {
            serve_(shared, next++);
        }
        return;
    }
    Line line{holder, {}};
    line.calls.push_back({shared, next});
    lines_.push_back(std::move(line));
}

void CallTurns::serve_next()
{
    if (lines_.empty()) {
        return;
    }
    // The lines are as they will be before the Method is called, which may throw.
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
    if (is_there(*server_, holder)) {
        serve_(batch, index);
    } else {
        server::MethodCall{batch, index}.fail(status::Bad_SessionClosed);
    }
}

} // namespace busbar::administration::detail
