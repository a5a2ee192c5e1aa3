#pragma once

#include <memory>
#include <utility>

#include <asio/any_io_executor.hpp>
#include <asio/async_result.hpp>

#include <busbar/client/client.hpp>
#include <busbar/core/api.hpp>
#include <busbar/net/detail/async_operation.hpp>
#include <busbar/net/reverse_listener.hpp>

namespace busbar::net {

/// A client::Client on TCP connections of an Asio executor, for callbacks, futures and C++20
/// coroutines:
///
///     const Result<ReadResponse> response = co_await client.call<ReadResponse>(request,
///                                                                 asio::use_awaitable);
///
/// Everything runs on the executor, which must be one thread or a strand; but connect(), call() and
/// close() may be called on any thread, as asio::use_future needs it, if their handlers have no
/// cancellation slot. Handlers run later, on the executor or their own; their exceptions come out
/// of its run(). Exceptions of the Client's own callbacks are logged. Errors are values, never
/// exceptions. An operation that is cancelled, in whatever way, ends with
/// Bad_RequestCancelledByClient; a server that has its request may still carry it out. Creating one
/// sets M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of glibc's malloc, as a BlockingClient does.
class BUSBAR_API AsyncClient {
public:
    /// `environment`, which must have a log, must outlive the object.
    AsyncClient(asio::any_io_executor executor, client::ClientConfig config,
                const channel::ChannelEnvironment& environment);
    AsyncClient(const AsyncClient&) = delete;
    AsyncClient& operator=(const AsyncClient&) = delete;
    /// Drops the connection at once; operations under way end with Bad_ConnectionClosed.
    ~AsyncClient();

    /// Uses the server's connections of `listener`, with ClientConfig::is_reverse. Call it before
    /// connect().
    void take_from(ReverseListener& listener);

    using executor_type = asio::any_io_executor;
    [[nodiscard]] executor_type get_executor() const { return executor_of(*impl_); }
    /// The Client that is driven here; after changing its settings, call wake().
    [[nodiscard]] client::Client& client();
    void wake();

    /// Completes with Result<void> when the session is open, with the first failure that another
    /// attempt cannot cure, or at `timeout` with Bad_Timeout, never later. The Client keeps trying
    /// unless it is closed.
    template <typename CompletionToken>
    auto connect(Duration timeout, CompletionToken&& token)
    {
        return asio::async_initiate<CompletionToken, void(Result<void>)>(
            [](auto handler, std::shared_ptr<Impl> impl, Duration limit) {
                using Operation = detail::WaitOperation<decltype(handler), Result<void>>;
                auto operation = make<Operation>(*impl, std::move(handler));
                begin_connect(std::move(impl), std::move(operation), limit);
            },
            token, impl_, timeout);
    }
    /// Completes with Result<Response>.
    template <typename Response, typename Request, typename CompletionToken>
    auto call(Request request, CompletionToken&& token, client::RequestOptions options = {})
    {
        return asio::async_initiate<CompletionToken, void(Result<Response>)>(
            [](auto handler, std::shared_ptr<Impl> impl, Request body,
               const client::RequestOptions& wishes) {
                using Operation = detail::AwaitedCall<Response, Request, decltype(handler)>;
                auto operation =
                    make<Operation>(*impl, std::move(handler), std::move(body), wishes);
                begin_call(std::move(impl), std::move(operation));
            },
            token, impl_, std::move(request), options);
    }
    /// Completes with void when session and channel are closed, after two seconds at most.
    template <typename CompletionToken>
    auto close(CompletionToken&& token)
    {
        return asio::async_initiate<CompletionToken, void()>(
            [](auto handler, std::shared_ptr<Impl> impl) {
                using Operation = detail::WaitOperation<decltype(handler)>;
                auto operation = make<Operation>(*impl, std::move(handler));
                begin_close(std::move(impl), std::move(operation));
            },
            token, impl_);
    }

private:
    /// Outlives the object until all operations have completed.
    struct Impl;

    template <typename Operation, typename... Arguments>
    static std::shared_ptr<Operation> make(const Impl& impl, Arguments&&... arguments)
    {
        auto operation =
            std::make_shared<Operation>(executor_of(impl), std::forward<Arguments>(arguments)...);
        operation->watch_cancellation();
        return operation;
    }
    static asio::any_io_executor executor_of(const Impl& impl);
    static void begin_connect(std::shared_ptr<Impl> impl,
                              std::shared_ptr<detail::AsyncOperation> operation, Duration timeout);
    static void begin_call(std::shared_ptr<Impl> impl,
                           std::shared_ptr<detail::AsyncOperation> operation);
    static void begin_close(std::shared_ptr<Impl> impl,
                            std::shared_ptr<detail::AsyncOperation> operation);

    std::shared_ptr<Impl> impl_;
};

} // namespace busbar::net
