#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <memory>

#include <busbar/core/log.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/method.hpp>

#include "permissions.hpp"

namespace busbar::administration::detail {

/// Serves the Methods of Calls one at a time: the server's thread looks after its connections
/// between two of them, and sessions take turns. Methods of administration write files, list
/// folders or check whole configurations, and one Call may have a thousand of them.
///
/// The first Method of a session that has nothing waiting is served at once. Methods of one session
/// are served in the order in which they came. What waits for a session that is over, or that has
/// another user by then, answers Bad_SessionClosed and is not done; nor is what the user may not do
/// any more, or what nobody waits for any more. A Method that throws answers Bad_OutOfMemory or
/// Bad_InternalError, unless it was answered, and the log is told.
///
/// On the server's thread.
class CallTurns {
public:
    /// Serves the Method with this index, now or later.
    using Serve =
        std::function<void(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)>;

    CallTurns(Serve serve, LogSink& log) : serve_{std::move(serve)}, log_{&log} {}

    /// Names the server whose sessions call; to be called before the first add(). Without a server
    /// all Methods are served at once.
    void set_server(server::Server& server) { server_ = &server; }
    /// As DataSource::attach.
    void attach(server::Waker* waker) { waker_ = waker; }

    void add(server::CallBatch batch);
    /// Serves one of those that wait, and wakes the server again if there are more.
    void serve_next();

private:
    struct Waiting {
        std::shared_ptr<server::CallBatch> batch;
        std::size_t next;
    };
    struct Line {
        Holder holder;
        std::deque<Waiting> calls;
    };

    [[nodiscard]] Line* find(const Holder& holder);
    [[nodiscard]] StatusCode check_waiting(const Holder& holder, const server::CallBatch& batch,
                                           std::size_t index) const;
    /// False without a Waker.
    bool wake();
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);

    Serve serve_;
    LogSink* log_;
    server::Server* server_{nullptr};
    std::list<Line> lines_; // the next one in front; none is without calls
    server::Waker* waker_{nullptr};
};

} // namespace busbar::administration::detail
