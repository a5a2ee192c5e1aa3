#include <busbar/net/blocking_client.hpp>

#include <atomic>
#include <cerrno>
#include <system_error>

#include <asio/error.hpp>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <busbar/net/reverse_listener.hpp>

#include "client_driver.hpp"

namespace busbar::net {

namespace {

/// Wakes up the code that waits in an io_context, from anywhere.
class Interrupter {
public:
    explicit Interrupter(asio::io_context& context)
        : event_{context, ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)}
    {
        wait();
    }
    /// Async-signal-safe: a lock-free flag and a system call that does not block.
    void interrupt()
    {
        const int saved = errno;
        is_interrupted_ = true;
        const std::uint64_t one = 1;
        static_cast<void>(!::write(event_.native_handle(), &one, sizeof one));
        errno = saved;
    }
    /// Returns true once for all requests so far.
    [[nodiscard]] bool take() { return is_interrupted_.exchange(false); }

private:
    static_assert(std::atomic<bool>::is_always_lock_free);

    void wait()
    {
        event_.async_wait(asio::posix::stream_descriptor::wait_read, [this](std::error_code error) {
            std::uint64_t count = 0;
            if (!error) {
                static_cast<void>(!::read(event_.native_handle(), &count, sizeof count));
                wait();
            }
        });
    }

    asio::posix::stream_descriptor event_;
    std::atomic<bool> is_interrupted_{false};
};

/// Ends a wait in an io_context, once for each call of arm(), when a descriptor is readable. It
/// uses a separate epoll: asio would make the descriptor non-blocking for other processes, too.
class InputWatch {
public:
    explicit InputWatch(asio::io_context& context) : epoll_{context} {}

    Result<void> watch(int descriptor)
    {
        epoll_.close();
        is_armed_ = false;
        const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
        if (epoll < 0) {
            return fail(status::Bad_CommunicationError);
        }
        epoll_.assign(epoll);
        ::epoll_event event{};
        event.events = EPOLLIN;
        if (::epoll_ctl(epoll, EPOLL_CTL_ADD, descriptor, &event) != 0) {
            epoll_.close();
            return fail(status::Bad_CommunicationError);
        }
        return {};
    }
    void arm()
    {
        if (epoll_.is_open() && !is_armed_) {
            is_armed_ = true;
            epoll_.async_wait(asio::posix::stream_descriptor::wait_read,
                              [this](std::error_code error) {
                                  if (error != asio::error::operation_aborted) {
                                      is_armed_ = false;
                                  }
                              });
        }
    }

private:
    asio::posix::stream_descriptor epoll_;
    bool is_armed_{false};
};

} // namespace

struct BlockingClient::Impl {
    Impl(client::ClientConfig config, const channel::ChannelEnvironment& environment)
        : driver{std::make_shared<detail::ClientDriver>(context.get_executor(), std::move(config),
                                                        environment)},
          log{environment.log}
    {
    }

    enum class End { Done, Interrupted, Late };
    End run_until(const std::function<bool()>& is_done, TimePoint until);

    asio::io_context context{1};
    Interrupter interrupter{context};
    InputWatch input{context};
    std::shared_ptr<detail::ClientDriver> driver;
    LogSink* log;
    std::optional<ReverseListener> listener;
};

BlockingClient::Impl::End BlockingClient::Impl::run_until(const std::function<bool()>& is_done,
                                                          TimePoint until)
{
    if (driver->is_stepping()) {
        return End::Interrupted; // a handler that waits would wait for itself
    }
    driver->step();
    input.arm();
    while (!is_done()) {
        if (interrupter.take()) {
            return End::Interrupted;
        }
        if (detail::now() >= until) {
            return End::Late;
        }
        context.restart();
        context.run_one_until(until);
    }
    return End::Done;
}

BlockingClient::BlockingClient(client::ClientConfig config,
                               const channel::ChannelEnvironment& environment)
    : impl_{std::make_unique<Impl>(std::move(config), environment)}
{
}

BlockingClient::~BlockingClient()
{
    impl_->driver->stop();
}

Result<std::uint16_t> BlockingClient::listen(std::string_view address, std::uint16_t port,
                                             const ReverseListenerLimits& limits)
{
    impl_->listener.emplace(impl_->context.get_executor(), *impl_->log, limits);
    impl_->driver->take_from(impl_->listener->queue_);
    return impl_->listener->listen(address, port);
}

Result<void> BlockingClient::connect(Duration timeout)
{
    client::Client& client = impl_->driver->client();
    client.connect(detail::now());
    const auto is_decided = [&] {
        return client.state() == client::ClientState::Ready ||
               client.state() == client::ClientState::Closed;
    };
    const auto end = impl_->run_until(is_decided, detail::after(timeout));
    if (end != Impl::End::Done) {
        return fail(end == Impl::End::Late ? status::Bad_Timeout : status::Bad_RequestInterrupted);
    }
    if (client.state() == client::ClientState::Ready) {
        return {};
    }
    const StatusCode why = client.last_error();
    return fail(why.is_bad() ? why : status::Bad_ConnectionClosed);
}

bool BlockingClient::run_until(const std::function<bool()>& is_done, Duration timeout)
{
    return impl_->run_until(is_done, detail::after(timeout)) == Impl::End::Done;
}

bool BlockingClient::run_for(Duration time)
{
    return impl_->run_until([] { return false; }, detail::after(time)) == Impl::End::Late;
}

Result<void> BlockingClient::wake_on(int descriptor)
{
    return impl_->input.watch(descriptor);
}

void BlockingClient::interrupt()
{
    impl_->interrupter.interrupt();
}

bool BlockingClient::close()
{
    detail::ClientDriver& driver = *impl_->driver;
    driver.client().close(detail::now());
    const auto is_over = [&] {
        return driver.client().state() == client::ClientState::Closed && !driver.has_connection();
    };
    return impl_->run_until(is_over, detail::after(std::chrono::seconds{2})) !=
           Impl::End::Interrupted;
}

client::Client& BlockingClient::client()
{
    return impl_->driver->client();
}

} // namespace busbar::net
