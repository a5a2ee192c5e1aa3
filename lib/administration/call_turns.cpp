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
    const Holder holder = server_ != nullptr ? holder_of(*server_, shared->caller()) : Holder{};
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
    lines_.push_back({holder, {}});
    lines_.back().calls.push_back({shared, next});
}

void CallTurns::serve_next()
{
    if (lines_.empty()) {
        return;
    }
    // All is as it will be before the Method is called, which may throw.
    Line line = std::move(lines_.front());
    lines_.pop_front();
    Waiting& first = line.calls.front();
    const std::shared_ptr<server::CallBatch> batch = first.batch;
    const std::size_t index = first.next++;
    const Holder holder = line.holder;
    if (first.next == batch->size()) {
        line.calls.pop_front();
    }
    if (!line.calls.empty()) {
        lines_.push_back(std::move(line));
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
