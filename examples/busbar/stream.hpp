#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "connection.hpp"

namespace busbar::cli {

/// When a command that would run for ever ends.
struct StreamEnd {
    std::uint64_t count{0}; // 0 for no end
    double seconds{0};
};
void add_stream_options(CLI::App& command, StreamEnd& end);

/// Waits for what a Subscription delivers. Handlers put into a Stream what is to be done, which may
/// throw, and run() does it outside of them.
class Stream {
public:
    Stream(Context& context, Connection& connection, const StreamEnd& end);
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    /// Closes the connection, so that no handler is called later.
    ~Stream() { connection_->close(); }

    void push(std::function<void()> work) { work_.push_back(std::move(work)); }
    /// One more of what StreamEnd counts; false if that is enough already.
    bool count();
    /// Until the end; throws Interrupted after Ctrl+C. `tick` is called after everything that
    /// happened and now and then.
    void run(const std::function<void()>& tick = [] {});

    /// Handlers that report gaps and failures; the others are the caller's. `node_of` names an
    /// item.
    [[nodiscard]] client::SubscriptionHandlers
    handlers(std::function<std::string(client::ItemHandle)> node_of);

private:
    void watch_connection();
    void report(const std::string& text);
    void report_gap(const client::Gap& gap, const std::vector<std::string>& nodes);

    Context* context_;
    Connection* connection_;
    StreamEnd end_;
    std::uint64_t counted_{0};
    bool is_created_{false};
    bool was_lost_{false};
    std::deque<std::function<void()>> work_;
};

} // namespace busbar::cli
