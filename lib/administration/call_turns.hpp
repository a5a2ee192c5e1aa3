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

/// Serves the Methods of Calls one at a time, so that the server's thread handles its connections
/// in between and sessions take turns. Methods of administration write files, list folders or check
/// whole configurations, and one Call may have a thousand of them.
///
/// The first Method of a session without waiting ones is served at once. Methods of one session are
/// served in the order of arrival. A waiting Method answers Bad_SessionClosed, without being
/// called, if its session has ended or has another user; nor is it called if the user has lost the
/// right, or the client no longer waits. A Method that throws answers Bad_OutOfMemory or
/// Bad_InternalError, unless it had answered, and the log is told.
///
/// Used on the server's thread.
class CallTurns {
public:
    /// Serves the Method with this index, now or later.
    using Serve =
        std::function<void(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)>;

    CallTurns(Serve serve, LogSink& log) : serve_{std::move(serve)}, log_{&log} {}

    /// Sets the server whose sessions call; must be called before the first add(). Without a server
    /// all Methods are served at once.
    void set_server(server::Server& server) { server_ = &server; }
    /// Sets the Waker, see DataSource::attach.
    void attach(server::Waker* waker) { waker_ = waker; }

    void add(server::CallBatch batch);
    /// Serves one waiting Method, and wakes the server again if there are more.
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
    /// Wakes the server; false without a Waker.
    bool wake();
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);

    Serve serve_;
    LogSink* log_;
    server::Server* server_{nullptr};
    std::list<Line> lines_; // the next line is first; none is empty
    server::Waker* waker_{nullptr};
};

} // namespace busbar::administration::detail
