#pragma once

#include <memory>
#include <utility>

#include <asio/any_io_executor.hpp>
#include <asio/associated_cancellation_slot.hpp>
#include <asio/async_result.hpp>

#include <busbar/client/client.hpp>

namespace busbar::net {

/// A client::Client on TCP connections of an Asio executor, for callbacks, futures and C++20
/// coroutines:
///
///     const Result<ReadResponse> response = co_await client.call<ReadResponse>(request,
///                                                                 asio::use_awaitable);
///
/// All calls on the executor, which must be one thread or a strand; handlers run there. Errors are
/// values, never exceptions. A cancelled operation ends with Bad_RequestCancelledByClient.
class AsyncClient {
public:
    /// `environment` must outlive the object.
    AsyncClient(asio::any_io_executor executor, client::ClientConfig config,
                const channel::ChannelEnvironment& environment);
    AsyncClient(const AsyncClient&) = delete;
    AsyncClient& operator=(const AsyncClient&) = delete;
    /// Drops the connection at once; operations under way end with Bad_ConnectionClosed.
    ~AsyncClient();

    /// What is driven here; after changing its wishes call wake().
    [[nodiscard]] client::Client& client();
    void wake();

    /// Completes with Result<void> when the session is there, or with the first failure that
    /// another attempt cannot mend, or after `timeout`: Bad_Timeout, never later. The Client goes
    /// on trying unless it is closed.
    template <typename CompletionToken>
    auto connect(Duration timeout, CompletionToken&& token);
    /// Completes with Result<Response>.
    template <typename Response, typename Request, typename CompletionToken>
    auto call(Request request, CompletionToken&& token, client::RequestOptions options = {});
    /// Completes with void when session and channel are closed, after two seconds at most.
    template <typename CompletionToken>
    auto close(CompletionToken&& token);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace busbar::net
