#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include <busbar/client/client.hpp>
#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/net/reverse_limits.hpp>

namespace busbar::net {

/// A client::Client for programs that do one thing after the other. The connection is served only
/// while a call of this class waits. One thread. Handlers must not make calls that wait: these end
/// as if interrupted. Exceptions of handlers are logged. Creating one sets M_TRIM_THRESHOLD and
/// M_MMAP_THRESHOLD of glibc's malloc, as a ServerLoop does: free memory, up to 32 MB, returns to
/// the system in a call that waits, from ten seconds on after it was needed.
class BUSBAR_API BlockingClient {
public:
    /// `environment`, which must have a log, must outlive the object.
    BlockingClient(client::ClientConfig config, const channel::ChannelEnvironment& environment);
    BlockingClient(const BlockingClient&) = delete;
    BlockingClient& operator=(const BlockingClient&) = delete;
    /// Drops the connection at once; use close() to close the session.
    ~BlockingClient();

    /// Listens for the server, with ClientConfig::is_reverse, as a ReverseListener does, but only
    /// while a call of this class waits. Call it before connect(). Returns the port, or
    /// Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port,
                                               const ReverseListenerLimits& limits = {});
    /// Waits for the session (or the channel, if no session is wanted), at most `timeout`.
    /// Bad_Timeout, Bad_RequestInterrupted, or the first failure that another attempt cannot cure.
    /// The Client keeps trying in later calls, unless it is closed.
    [[nodiscard]] Result<void> connect(Duration timeout = std::chrono::seconds{20});
    /// Sends `request` and waits for its response; also Bad_RequestInterrupted. Copies a request
    /// only if it is const. Another one has the connection's header for a moment: until the return
    /// neither handlers nor other threads may use it.
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request&& request, client::RequestOptions options = {})
    {
        std::optional<Result<Response>> answer;
        const auto done = [&](Result<Response> result) { answer = std::move(result); };
        client::RequestId id = 0;
        if constexpr (std::is_lvalue_reference_v<Request> &&
                      !std::is_const_v<std::remove_reference_t<Request>>) {
            id = client().template call<Response>(Lent<std::decay_t<Request>>{&request, {}}, done,
                                                  options);
        } else {
            id = client().template call<Response>(std::forward<Request>(request), done, options);
        }
        if (!run_until([&] { return answer.has_value(); })) {
            client().cancel(id);
            return fail(status::Bad_RequestInterrupted);
        }
        return *std::move(answer);
    }
    /// Starts an operation, whose handler gets a T, and waits for that T; also
    /// Bad_RequestInterrupted.
    ///
    ///     client.wait_for<std::vector<DataValue>>([&](auto done) {
    ///         return client::read(client.client(), items, done);
    ///     });
    template <typename T, typename Begin>
    [[nodiscard]] Result<T> wait_for(Begin begin)
    {
        std::optional<T> result;
        client::Operation operation =
            begin(std::function<void(T)>{[&](T value) { result = std::move(value); }});
        if (!run_until([&] { return result.has_value(); })) {
            operation.cancel();
            return fail(status::Bad_RequestInterrupted);
        }
        return *std::move(result);
    }
    /// Serves the connection until `is_done`, which is called after everything that happens,
    /// returns true. False if it was interrupted or `timeout` has passed.
    bool run_until(const std::function<bool()>& is_done, Duration timeout = Duration::max());
    /// Serves the connection for this long: Subscriptions deliver meanwhile. Ends early, with
    /// false, if interrupted.
    bool run_for(Duration time);
    /// Makes run_until() also call `is_done` when `descriptor` is readable, such as that of a
    /// terminal; once in each call, so that a call that ignores it continues to wait. The
    /// descriptor is neither read nor changed, and must stay open as long as this object lives. A
    /// later one replaces it. Bad_CommunicationError for descriptors that cannot be waited for,
    /// such as a file.
    Result<void> wake_on(int descriptor);
    /// Ends the call that waits now, or the next one. Called from any thread or a signal handler.
    void interrupt();
    /// Closes session and channel and waits until that is sent, at most two seconds. False if it
    /// was interrupted; later calls that wait go on with it then.
    bool close();

    [[nodiscard]] client::Client& client();

private:
    /// A request of the caller of call(), which has the header of the connection only while it is
    /// encoded.
    template <typename Request>
    struct Lent {
        static constexpr std::uint32_t binary_encoding_id = Request::binary_encoding_id;

        friend void encode(binary::Writer& writer, const Lent& lent)
        {
            RequestHeader sent = lent.request_header; // may throw, before anything is changed
            RequestHeader own = std::exchange(lent.request->request_header, std::move(sent));
            busbar::detail::Undo undo{[&] { lent.request->request_header = std::move(own); }};
            encode(writer, *lent.request);
        }

        Request* request;
        RequestHeader request_header;
    };

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
