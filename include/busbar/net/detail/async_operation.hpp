#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include <asio/any_io_executor.hpp>
#include <asio/associated_cancellation_slot.hpp>
#include <asio/associated_executor.hpp>
#include <asio/execution/outstanding_work.hpp>
#include <asio/post.hpp>
#include <asio/prefer.hpp>

#include <busbar/client/client.hpp>
#include <busbar/core/api.hpp>

namespace busbar::net::detail {

/// An operation of an AsyncClient that is under way, without its types.
class BUSBAR_API AsyncOperation : public std::enable_shared_from_this<AsyncOperation> {
public:
    AsyncOperation() = default;
    AsyncOperation(const AsyncOperation&) = delete;
    AsyncOperation& operator=(const AsyncOperation&) = delete;
    virtual ~AsyncOperation() = default;

    /// Starts it; on the executor, once, unless it was cancelled before.
    virtual void start(client::Client& client) = 0;
    /// Forgets what start() requested and completes with `status`; does nothing if it is complete.
    virtual void end(StatusCode status) = 0;
    [[nodiscard]] virtual bool is_complete() const = 0;

    /// Called when it completes; may drop the last reference to it.
    std::function<void()> on_complete;
};

/// An operation that ends by calling `Handler` with `Results`: through the handler's executor,
/// never from within the call that ends it.
template <typename Handler, typename... Results>
class HandledOperation : public AsyncOperation {
public:
    HandledOperation(const asio::any_io_executor& executor, Handler handler)
        : executor_{asio::prefer(asio::get_associated_executor(handler, executor),
                                 asio::execution::outstanding_work.tracked)},
          handler_{std::move(handler)}
    {
    }

    /// Call it once the object is owned. The slot may keep its handler after completion: it does
    /// nothing then, and must not be removed from a slot that is being emitted.
    void watch_cancellation()
    {
        auto slot = asio::get_associated_cancellation_slot(*handler_);
        if (slot.is_connected()) {
            slot.assign([weak = weak_from_this()](asio::cancellation_type type) {
                const auto self = weak.lock();
                if (self && type != asio::cancellation_type::none) {
                    self->end(status::Bad_RequestCancelledByClient);
                }
            });
        }
    }
    void complete(Results... results)
    {
        if (!handler_) {
            return;
        }
        const auto self = shared_from_this();
        Handler handler = *std::move(handler_);
        handler_.reset();
        asio::post(executor_, [handler = std::move(handler), arguments = std::tuple<Results...>{
                                                                 std::move(results)...}]() mutable {
            std::apply(std::move(handler), std::move(arguments));
        });
        if (const auto done = std::exchange(on_complete, nullptr)) {
            done();
        }
    }
    [[nodiscard]] bool is_complete() const override { return !handler_; }

private:
    using AssociatedExecutor = asio::associated_executor_t<Handler, asio::any_io_executor>;
    using Executor = std::decay_t<decltype(asio::prefer(
        std::declval<AssociatedExecutor>(), asio::execution::outstanding_work.tracked))>;

    Executor executor_;
    std::optional<Handler> handler_;
};

/// A request with its awaited response.
template <typename Response, typename Request, typename Handler>
class AwaitedCall final : public HandledOperation<Handler, Result<Response>> {
public:
    AwaitedCall(const asio::any_io_executor& executor, Handler handler, Request request,
                const client::RequestOptions& options)
        : HandledOperation<Handler, Result<Response>>{executor, std::move(handler)},
          request_{std::move(request)}, options_{options}
    {
    }

    void start(client::Client& client) override
    {
        client_ = &client;
        id_ = client.template call<Response>(
            std::move(request_),
            [self = std::static_pointer_cast<AwaitedCall>(this->shared_from_this())](
                Result<Response> response) { self->complete(std::move(response)); },
            options_);
    }
    void end(StatusCode status) override
    {
        if (client_ != nullptr && !this->is_complete()) {
            client_->cancel(id_);
        }
        this->complete(fail(status));
    }

private:
    Request request_;
    client::RequestOptions options_;
    client::Client* client_{nullptr}; // outlives the operation's completion
    client::RequestId id_{0};
};

/// Waits for a change of the connection; completes with Result<void>, or with no result.
template <typename Handler, typename... Results>
class WaitOperation final : public HandledOperation<Handler, Results...> {
public:
    using HandledOperation<Handler, Results...>::HandledOperation;

    void start(client::Client&) override {}
    void end(StatusCode status) override
    {
        if constexpr (sizeof...(Results) == 0) {
            this->complete();
        } else {
            this->complete(status.is_bad() ? Result<void>{fail(status)} : Result<void>{});
        }
    }
};

} // namespace busbar::net::detail
