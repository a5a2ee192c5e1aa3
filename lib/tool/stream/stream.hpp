#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tool/connection/connection.hpp"

namespace busbar::tool {

/// When a command that would run for ever ends.
struct StreamEnd {
    std::uint64_t count{0}; // 0 for no end
    double seconds{0};
};
void add_stream_options(CLI::App& command, StreamEnd& end);

/// Is told what becomes of the connection; in run() of the Stream.
class StreamListener {
public:
    StreamListener() = default;
    StreamListener(const StreamListener&) = delete;
    StreamListener& operator=(const StreamListener&) = delete;
    virtual ~StreamListener() = default;

    virtual void lost(StatusCode why) = 0;
    virtual void back() = 0;
    virtual void missed(const client::Gap& gap) = 0;
    /// The server has no subscriptions.
    virtual void polling() = 0;
};

/// Tells it in lines on standard error, gaps in JSON on standard output.
class StreamReporter final : public StreamListener {
public:
    explicit StreamReporter(Context& context) : context_{&context} {}

    void lost(StatusCode why) override;
    void back() override;
    void missed(const client::Gap& gap) override;
    void polling() override;

private:
    void report(const std::string& text);

    Context* context_;
};

/// Waits for the notifications of a Subscription. Handlers only add work, which may throw, to a
/// Stream, and run() does the work outside of them.
class Stream {
public:
    Stream(Context& context, Connection& connection, const StreamEnd& end);
    /// Reports to another listener than a StreamReporter.
    Stream(Context& context, Connection& connection, const StreamEnd& end,
           std::unique_ptr<StreamListener> listener);
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    /// Closes the connection, so that no handler is called later.
    ~Stream();

    void push(std::function<void()> work) { work_.push_back(std::move(work)); }
    /// Counts one value or event more; false if StreamEnd does not allow more.
    bool count();
    /// Makes run() not end by StreamEnd's count before `is_complete`.
    void end_after(std::function<bool()> is_complete) { is_complete_ = std::move(is_complete); }
    /// run() ends after what happens now.
    void stop() { is_stopped_ = true; }
    /// Makes run() call `tick` soon when this descriptor is readable, and end when its writer is
    /// gone.
    void wake_on(int descriptor);
    [[nodiscard]] bool has_lost_input() const;
    /// Until the end; throws Interrupted after Ctrl+C. `tick` is called after everything that
    /// happened and now and then.
    void run(const std::function<void()>& tick = [] {});

    /// Handlers that tell of gaps and failures; the others are the caller's.
    [[nodiscard]] client::SubscriptionHandlers handlers();

private:
    void watch_connection();
    [[nodiscard]] bool has_input() const;
    [[nodiscard]] bool has_enough() const;

    Context* context_;
    Connection* connection_;
    std::unique_ptr<StreamListener> listener_;
    StreamEnd end_;
    std::function<bool()> is_complete_{[] { return true; }};
    std::uint64_t counted_{0};
    int input_{-1};
    bool is_stopped_{false};
    bool is_created_{false};
    bool was_lost_{false};
    std::deque<std::function<void()>> work_;
};

} // namespace busbar::tool
