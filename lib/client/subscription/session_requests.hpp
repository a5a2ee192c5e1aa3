#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <utility>

#include <busbar/client/requester.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/function_ref.hpp>

namespace busbar::client::detail {

/// The pending requests of Subscriptions, which end with their session, and whether there is work
/// that no answer will trigger.
class SessionRequests {
public:
    /// Maximum number of items in one request, if neither the user nor the server sets a lower
    /// limit.
    static constexpr std::size_t default_batch = 1'000;

    /// `answered` is called after the handler of each answer.
    SessionRequests(Requester& requester, std::function<void()> answered);
    ~SessionRequests();
    SessionRequests(const SessionRequests&) = delete;
    SessionRequests& operator=(const SessionRequests&) = delete;

    void begin_session();
    /// Forgets pending requests.
    void end_session();
    void cancel_all();
    [[nodiscard]] bool has_session() const { return session_ != nullptr; }
    /// Returns a function that is true as long as the present session lasts. May outlive this.
    [[nodiscard]] std::function<bool()> in_session() const;

    /// Passes the Result to `handle`; not after end_session() or the end of this. Only in a
    /// session.
    template <typename Response, typename Request, typename Handle>
    void send(Request request, Handle handle, Duration timeout = {});

    [[nodiscard]] TimePoint now() const { return requester_.now(); }
    [[nodiscard]] const ServerInfo& server() const { return requester_.server(); }
    /// For services over several requests.
    [[nodiscard]] Requester& requester() { return requester_; }

    /// Calls `work`. If that runs out of memory, its progress is unknown: has_failed() from then
    /// on. All handlers of answers are called through this.
    void watch(FunctionRef<void()> work);
    [[nodiscard]] bool has_failed() const { return has_failed_; }
    void forget_failure() { has_failed_ = false; }

    /// Schedules work at the next deadline, which is now.
    void call_for_work() { has_work_ = true; }
    void begin_work() { has_work_ = false; }
    [[nodiscard]] bool has_work() const { return has_work_; }

private:
    Requester& requester_;
    std::function<void()> answered_;
    bool has_work_{false};
    bool has_failed_{false};
    std::shared_ptr<bool> session_; // another one for each session
    std::uint64_t last_token_{0};
    std::unordered_map<std::uint64_t, RequestId> requests_;
};

template <typename Response, typename Request, typename Handle>
void SessionRequests::send(Request request, Handle handle, Duration timeout)
{
    const std::uint64_t token = ++last_token_;
    RequestId& id = requests_[token];
    busbar::detail::Undo undo{[&] { requests_.erase(token); }};
    id = requester_.call<Response>(
        std::move(request),
        [this, token, handle = std::move(handle)](Result<Response> response) {
            requests_.erase(token);
            watch([&] {
                handle(std::move(response));
                answered_();
            });
        },
        {timeout, false});
    undo.keep();
}

} // namespace busbar::client::detail
