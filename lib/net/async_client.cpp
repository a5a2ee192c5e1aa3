#include <busbar/net/async_client.hpp>

#include <list>
#include <optional>

#include <asio/dispatch.hpp>
#include <asio/steady_timer.hpp>

#include "client_driver.hpp"

namespace busbar::net {

using detail::AsyncOperation;

struct AsyncClient::Impl : std::enable_shared_from_this<Impl> {
    /// An operation that waits for the connection to be open, or closed.
    struct Wait {
        std::shared_ptr<AsyncOperation> operation;
        std::unique_ptr<asio::steady_timer> timer;
    };
    using Waits = std::list<Wait>;

    Impl(asio::any_io_executor e, client::ClientConfig config,
         const channel::ChannelEnvironment& environment)
        : executor{e}, driver{std::make_shared<detail::ClientDriver>(e, std::move(config),
                                                                     environment)}
    {
        driver->on_step([this] { end_waits(); });
    }

    [[nodiscard]] client::ClientState state() const { return driver->client().state(); }
    void call(std::shared_ptr<AsyncOperation> operation);
    void wait(Waits& waits, std::shared_ptr<AsyncOperation> operation, Duration timeout,
              StatusCode when_late);
    void end_waits();
    void stop();

    const asio::any_io_executor executor;
    const std::shared_ptr<detail::ClientDriver> driver;
    std::list<std::shared_ptr<AsyncOperation>> calls;
    Waits connects;
    Waits closes;
    bool has_stopped{false};
};

void AsyncClient::Impl::call(std::shared_ptr<AsyncOperation> operation)
{
    const auto place = calls.insert(calls.end(), operation);
    operation->on_complete = [this, place] {
        calls.erase(place);
        if (!driver->is_stepping()) {
            driver->wake(); // it was cancelled: its deadline is obsolete
        }
    };
    operation->start(driver->client());
    driver->wake();
}

void AsyncClient::Impl::wait(Waits& waits, std::shared_ptr<AsyncOperation> operation,
                             Duration timeout, StatusCode when_late)
{
    const auto place = waits.insert(waits.end(), {operation, nullptr});
    operation->on_complete = [&waits, place] { waits.erase(place); };
    const TimePoint deadline = detail::after(timeout);
    if (deadline != no_deadline) {
        place->timer = std::make_unique<asio::steady_timer>(executor, deadline);
        place->timer->async_wait([operation, when_late](std::error_code error) {
            if (!error) {
                operation->end(when_late);
            }
        });
    }
    driver->wake();
}

/// Ends waits whose condition the Client has reached.
void AsyncClient::Impl::end_waits()
{
    const bool is_closed = state() == client::ClientState::Closed;
    const bool is_ready = state() == client::ClientState::Ready;
    const StatusCode why = driver->client().last_error();
    while (!connects.empty() && (is_ready || is_closed)) {
        connects.front().operation->end(is_ready       ? status::Good
                                        : why.is_bad() ? why
                                                       : StatusCode{status::Bad_ConnectionClosed});
    }
    while (!closes.empty() && is_closed && !driver->has_connection()) {
        closes.front().operation->end(status::Good);
    }
}

void AsyncClient::Impl::stop()
{
    has_stopped = true;
    driver->stop();
    while (!calls.empty()) {
        calls.front()->end(status::Bad_ConnectionClosed);
    }
    for (Waits* waits : {&connects, &closes}) {
        while (!waits->empty()) {
            waits->front().operation->end(status::Bad_ConnectionClosed);
        }
    }
}

AsyncClient::AsyncClient(asio::any_io_executor executor, client::ClientConfig config,
                         const channel::ChannelEnvironment& environment)
    : impl_{std::make_shared<Impl>(std::move(executor), std::move(config), environment)}
{
}

AsyncClient::~AsyncClient()
{
    impl_->stop();
}

void AsyncClient::take_from(ReverseListener& listener)
{
    impl_->driver->take_from(listener.queue_);
}

client::Client& AsyncClient::client()
{
    return impl_->driver->client();
}

void AsyncClient::wake()
{
    impl_->driver->wake();
}

asio::any_io_executor AsyncClient::executor_of(const Impl& impl)
{
    return impl.executor;
}

namespace {

/// Calls `work` with an operation on the executor, unless it was cancelled on the way there.
template <typename Impl, typename Work>
void begin(std::shared_ptr<Impl> impl, std::shared_ptr<AsyncOperation> operation, Work work)
{
    const auto executor = impl->executor;
    asio::dispatch(executor, [impl = std::move(impl), operation = std::move(operation), work] {
        if (impl->has_stopped) {
            operation->end(status::Bad_ConnectionClosed);
        } else if (!operation->is_complete()) {
            work(*impl, operation);
        }
    });
}

} // namespace

void AsyncClient::begin_connect(std::shared_ptr<Impl> impl,
                                std::shared_ptr<AsyncOperation> operation, Duration timeout)
{
    begin(std::move(impl), std::move(operation), [timeout](Impl& on, const auto& started) {
        on.driver->client().connect(detail::now());
        on.wait(on.connects, started, timeout, status::Bad_Timeout);
    });
}

void AsyncClient::begin_call(std::shared_ptr<Impl> impl, std::shared_ptr<AsyncOperation> operation)
{
    begin(std::move(impl), std::move(operation),
          [](Impl& on, const auto& started) { on.call(started); });
}

void AsyncClient::begin_close(std::shared_ptr<Impl> impl, std::shared_ptr<AsyncOperation> operation)
{
    begin(std::move(impl), std::move(operation), [](Impl& on, const auto& started) {
        on.driver->client().close(detail::now());
        on.wait(on.closes, started, std::chrono::seconds{2}, status::Good);
    });
}

} // namespace busbar::net
