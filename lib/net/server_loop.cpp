#include <busbar/net/server_loop.hpp>

#include <atomic>
#include <exception>
#include <unordered_map>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/v6_only.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/post.hpp>
#include <asio/signal_set.hpp>
#include <fcntl.h>
#include <unistd.h>

#include "link.hpp"

namespace busbar::net {

namespace {

using asio::ip::tcp;

/// A pipe to oneself: writing one byte neither blocks nor allocates.
class PipeWaker final : public server::Waker {
public:
    explicit PipeWaker(asio::io_context& context) : reader_{context}
    {
        int ends[2] = {-1, -1};
        if (::pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0) {
            reader_.assign(ends[0]);
            writer_ = ends[1];
        }
    }
    ~PipeWaker() override
    {
        if (writer_ >= 0) {
            ::close(writer_);
        }
    }
    void wake() override
    {
        if (!is_awake_.exchange(true)) {
            const char byte = 0;
            static_cast<void>(!::write(writer_, &byte, 1));
        }
    }
    /// Calls `on_wake` on the loop's thread each time.
    template <typename OnWake>
    void wait(OnWake on_wake)
    {
        reader_.async_read_some(asio::buffer(buffer_),
                                [this, on_wake](std::error_code error, std::size_t) {
                                    if (!error) {
                                        is_awake_ = false;
                                        wait(on_wake);
                                        on_wake();
                                    }
                                });
    }

private:
    asio::posix::stream_descriptor reader_;
    int writer_{-1};
    std::atomic<bool> is_awake_{false};
    char buffer_[64]{};
};

/// The server itself logs what became of a connection.
void drain(server::Connection& connection)
{
    while (connection.next_event()) {
    }
}

} // namespace

struct ServerLoop::Impl {
    using ConnectionLink = detail::Link<server::Connection>;
    struct Client {
        std::unique_ptr<server::Connection> connection;
        std::shared_ptr<ConnectionLink> link;
    };

    explicit Impl(LogSink& l)
        : log{&l}, waker{context}, timer{context.get_executor()}, signals{context}
    {
    }

    void accept(tcp::acceptor& acceptor);
    void adopt(tcp::socket socket);
    void drop(std::uint64_t id);
    void after_activity();
    void await_deadline();
    void begin_stop();

    LogSink* log;
    asio::io_context context;
    PipeWaker waker;
    detail::DeadlineTimer timer;
    asio::signal_set signals;
    std::vector<std::unique_ptr<tcp::acceptor>> acceptors;
    std::unordered_map<std::uint64_t, Client> clients;
    server::Server* server{nullptr};
    bool is_stopping{false};
};

void ServerLoop::Impl::accept(tcp::acceptor& acceptor)
{
    acceptor.async_accept([this, &acceptor](std::error_code error, tcp::socket socket) {
        if (error == asio::error::operation_aborted) {
            return;
        }
        if (!error) {
            adopt(std::move(socket));
        } else {
            log->write(LogLevel::Warning, "net", "accept: " + error.message());
        }
        if (!is_stopping) {
            accept(acceptor);
        }
    });
}

void ServerLoop::Impl::adopt(tcp::socket socket)
{
    std::error_code error;
    const auto peer = socket.remote_endpoint(error);
    if (error) {
        return;
    }
    auto connection = server->connect(peer.address().to_string(), detail::now());
    if (!connection) {
        return; // the server has said why
    }
    auto owned = std::make_unique<server::Connection>(*std::move(connection));
    const std::uint64_t id = owned->id();
    auto link = std::make_shared<ConnectionLink>(
        std::move(socket), *owned,
        [this](ConnectionLink& changed) {
            drain(changed.engine());
            after_activity();
        },
        [this, id](ConnectionLink&) { asio::post(context, [this, id] { drop(id); }); });
    clients.emplace(id, Client{std::move(owned), link});
    link->start();
    after_activity();
}

void ServerLoop::Impl::drop(std::uint64_t id)
{
    clients.erase(id);
    after_activity();
}

/// What one connection did may have given others something to send.
void ServerLoop::Impl::after_activity()
{
    while (const auto id = server->next_changed()) {
        const auto found = clients.find(*id);
        if (found != clients.end()) {
            const auto link = found->second.link;
            link->pump();
        }
    }
    if (is_stopping && server->is_stopped() && clients.empty()) {
        context.stop();
        return;
    }
    await_deadline();
}

void ServerLoop::Impl::await_deadline()
{
    timer.await(server->next_deadline(), [this] {
        server->handle_deadline(detail::now());
        after_activity();
    });
}

void ServerLoop::Impl::begin_stop()
{
    if (std::exchange(is_stopping, true)) {
        return;
    }
    for (const auto& acceptor : acceptors) {
        std::error_code ignored;
        acceptor->close(ignored);
    }
    server->begin_shutdown(detail::now(), "the server is being stopped");
    after_activity();
}

ServerLoop::ServerLoop(LogSink& log) : impl_{std::make_unique<Impl>(log)} {}
ServerLoop::~ServerLoop() = default;

server::Waker& ServerLoop::waker()
{
    return impl_->waker;
}

Result<std::uint16_t> ServerLoop::listen(std::string_view address, std::uint16_t port)
{
    std::error_code error;
    const auto refuse = [&] {
        impl_->log->write(LogLevel::Error, "net",
                          "cannot listen on " + std::string{address} + ":" + std::to_string(port) +
                              ": " + error.message());
        return fail(status::Bad_CommunicationError);
    };
    auto ip = address.empty() ? asio::ip::address{asio::ip::address_v6::any()}
                              : asio::ip::make_address(std::string{address}, error);
    if (error) {
        return refuse();
    }
    auto acceptor = std::make_unique<tcp::acceptor>(impl_->context);
    acceptor->open(ip.is_v6() ? tcp::v6() : tcp::v4(), error);
    if (error && address.empty()) { // a machine without IPv6
        ip = asio::ip::address_v4::any();
        acceptor->open(tcp::v4(), error);
    }
    if (!error && ip.is_v6()) {
        acceptor->set_option(asio::ip::v6_only{!address.empty()}, error);
    }
    if (!error) {
        acceptor->set_option(tcp::acceptor::reuse_address{true}, error);
    }
    if (!error) {
        acceptor->bind({ip, port}, error);
    }
    if (!error) {
        acceptor->listen(asio::socket_base::max_listen_connections, error);
    }
    if (error) {
        return refuse();
    }
    const std::uint16_t bound = acceptor->local_endpoint(error).port();
    impl_->acceptors.push_back(std::move(acceptor));
    return bound;
}

void ServerLoop::stop_on_signals()
{
    impl_->signals.add(SIGINT);
    impl_->signals.add(SIGTERM);
    impl_->signals.async_wait([this](std::error_code error, int) {
        if (!error) {
            impl_->begin_stop();
        }
    });
}

void ServerLoop::run(server::Server& server)
{
    impl_->server = &server;
    server.start(detail::now());
    for (const auto& acceptor : impl_->acceptors) {
        impl_->accept(*acceptor);
    }
    impl_->waker.wait([this] {
        impl_->server->handle_completions(detail::now());
        impl_->after_activity();
    });
    impl_->await_deadline();
    while (!impl_->context.stopped()) {
        try {
            impl_->context.run();
        } catch (const std::exception& e) {
            impl_->log->write(LogLevel::Error, "net", std::string{"exception: "} + e.what());
        } catch (...) {
            impl_->log->write(LogLevel::Error, "net", "unknown exception");
        }
    }
    impl_->clients.clear();
}

void ServerLoop::stop()
{
    asio::post(impl_->context, [this] { impl_->begin_stop(); });
}

} // namespace busbar::net
