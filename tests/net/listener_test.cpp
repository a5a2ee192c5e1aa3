#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <csignal>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>
#include <sys/resource.h>

#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>

#include "channel/frame.hpp"
#include "machine.hpp"
#include "net/listener.hpp"

namespace listener_test {

using namespace busbar;
using asio::ip::tcp;

namespace {

class Lines final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view text) override
    {
        lines.emplace_back(text);
    }
    std::vector<std::string> lines;
};

/// No file can be opened as long as it is there.
class NoDescriptors {
public:
    NoDescriptors()
    {
        REQUIRE(::getrlimit(RLIMIT_NOFILE, &before_) == 0);
        rlimit none = before_;
        none.rlim_cur = 0;
        REQUIRE(::setrlimit(RLIMIT_NOFILE, &none) == 0);
    }
    NoDescriptors(const NoDescriptors&) = delete;
    NoDescriptors& operator=(const NoDescriptors&) = delete;
    ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }

private:
    rlimit before_{};
};

/// A server without a place for anybody, on a thread of its own.
class Narrow {
public:
    Narrow()
    {
        environment_.random = &random_;
        environment_.wall_clock = &clock_;
        environment_.log = &log_;
        port = *loop.listen("127.0.0.1", 0);
        server::ServerConfig config = test::server_config(port);
        config.limits.max_connections_per_address = 0;
        server_.emplace(*server::Server::create(std::move(config), environment_));
    }
    ~Narrow()
    {
        if (thread_.joinable()) {
            loop.stop();
            thread_.join();
        }
    }
    void run()
    {
        thread_ = std::thread{[this] { loop.run(*server_); }};
    }

    NullLog log_;
    net::ServerLoop loop{log_};
    std::uint16_t port{0};

private:
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    server::ServerEnvironment environment_;
    std::optional<server::Server> server_;
    std::thread thread_;
};

tcp::socket connect(asio::io_context& context, std::uint16_t port)
{
    tcp::socket socket{context};
    socket.connect({asio::ip::address_v4::loopback(), port});
    return socket;
}

} // namespace

// The sanitizer of undefined behaviour opens a pipe to look at the type of an object, and takes one
// for invalid that it could not look at.
#ifndef BUSBAR_SANITIZES_UNDEFINED
TEST_CASE("a listener without descriptors says so once and goes on when there are some", "[net]")
{
    asio::io_context context;
    Lines log;
    const auto listener = std::make_shared<net::detail::Listener>(context.get_executor(), log);
    const std::uint16_t port = *listener->open("127.0.0.1", 0);
    asio::io_context outside;
    const tcp::socket peer = connect(outside, port);
    int accepted = 0;
    {
        const NoDescriptors none;
        listener->start([&](const tcp::socket&) { ++accepted; });
        for (int handlers = 0; handlers < 5; ++handlers) { // to accept, to wait, to accept, ...
            context.run_one();
        }
    }
    REQUIRE(log.lines.size() == 1);
    CHECK(log.lines[0].find("Too many open files") != std::string::npos);
    CHECK(log.lines[0].find("Raise the limit of open files") != std::string::npos);
    CHECK(accepted == 0);
    while (accepted == 0) {
        context.run_one();
    }
    CHECK(log.lines.size() == 2);
    listener->close();
}

TEST_CASE("a listener whose trouble comes and goes does not fill the log", "[net]")
{
    asio::io_context context;
    Lines log;
    const auto listener = std::make_shared<net::detail::Listener>(context.get_executor(), log);
    const std::uint16_t port = *listener->open("127.0.0.1", 0);
    asio::io_context outside;
    std::vector<tcp::socket> peers;
    std::size_t accepted = 0;
    listener->start([&](const tcp::socket&) { ++accepted; });
    for (int times = 1; times <= 3; ++times) {
        peers.push_back(connect(outside, port));
        {
            const NoDescriptors none;
            context.run_one(); // to accept, and then it pauses
            CHECK(accepted < peers.size());
        }
        while (accepted < peers.size()) {
            context.run_one();
        }
    }
    CHECK(log.lines.size() == 2);
    // One that is closed while it pauses does not go on.
    peers.push_back(connect(outside, port));
    {
        const NoDescriptors none;
        context.run_one();
    }
    listener->close();
    context.run();
    CHECK(accepted == 3);
}

TEST_CASE("a listener that finds no descriptor for its port says so", "[net]")
{
    asio::io_context context;
    Lines log;
    const auto listener = std::make_shared<net::detail::Listener>(context.get_executor(), log);
    {
        const NoDescriptors none;
        CHECK(listener->open("", 0).error() == status::Bad_CommunicationError);
    }
    CHECK(log.lines == std::vector<std::string>{"cannot listen on :0: Too many open files"});
}
#endif

TEST_CASE("the log says why an address cannot be listened on", "[net]")
{
    asio::io_context context;
    const tcp::acceptor other{context, {asio::ip::address_v4::loopback(), 0}};
    const std::string taken = std::to_string(other.local_endpoint().port());
    Lines log;
    const auto open = [&](std::string_view address, std::uint16_t port) {
        return std::make_shared<net::detail::Listener>(context.get_executor(), log)
            ->open(address, port);
    };
    const auto error = status::Bad_CommunicationError;
    CHECK(open("127.0.0.1", other.local_endpoint().port()).error() == error);
    CHECK(open("plant", 0).error() == error);
    CHECK(open("192.0.2.1", 0).error() == error); // of documents, and of no machine
    CHECK(log.lines == std::vector<std::string>{
                           "cannot listen on 127.0.0.1:" + taken + ": Address already in use",
                           "cannot listen on plant:0: Invalid argument",
                           "cannot listen on 192.0.2.1:0: Cannot assign requested address"});
}

TEST_CASE("a listener without an address takes peers at every one of the machine", "[net]")
{
    asio::io_context context;
    Lines log;
    const auto listener = std::make_shared<net::detail::Listener>(context.get_executor(), log);
    const std::uint16_t port = *listener->open("", 0);
    std::vector<tcp::socket> accepted;
    listener->start([&](tcp::socket socket) { accepted.push_back(std::move(socket)); });
    listener->resume(); // which waits already
    asio::io_context outside;
    const tcp::socket first = connect(outside, port);
    tcp::socket second{outside};
    std::error_code error;
    second.connect({asio::ip::address_v6::loopback(), port}, error);
    // A machine may have no IPv6.
    const std::size_t expected = error ? 1 : 2;
    while (accepted.size() < expected) {
        context.run_one();
    }
    listener->close();
    context.run();
    CHECK(accepted.size() == expected);
    CHECK(log.lines.empty());
}

TEST_CASE("a peer that there is no place for gets an Error message", "[net]")
{
    Narrow narrow;
    narrow.run();
    asio::io_context context;
    const tcp::socket first = connect(context, narrow.port);
    tcp::socket second = connect(context, narrow.port);
    // It has sent its Hello already: closing at once would reset the connection.
    const std::array<char, 32> hello{'H', 'E', 'L', 'F', 32};
    asio::write(second, asio::buffer(hello));
    std::vector<std::byte> bytes(4'096);
    std::error_code end;
    bytes.resize(asio::read(second, asio::buffer(bytes), end));
    CHECK(end == asio::error::eof);
    REQUIRE(bytes.size() > channel::detail::header_size);
    const auto header = channel::detail::parse_frame_header(bytes, 4'096);
    REQUIRE(header);
    CHECK(header->type == channel::detail::MessageType::ERR);
    CHECK(header->size == bytes.size());
    const auto error =
        channel::detail::parse_error(std::span{bytes}.subspan(channel::detail::header_size));
    REQUIRE(error);
    CHECK(error->error == status::Bad_TcpServerTooBusy);
    CHECK_FALSE(error->reason.empty());
}

TEST_CASE("a listener accepts again whatever its handler threw", "[net]")
{
    asio::io_context context;
    Lines log;
    const auto listener = std::make_shared<net::detail::Listener>(context.get_executor(), log);
    const std::uint16_t port = *listener->open("127.0.0.1", 0);
    int accepted = 0;
    listener->start([&](const tcp::socket&) {
        ++accepted;
        throw std::bad_alloc{};
    });
    asio::io_context outside;
    const tcp::socket first = connect(outside, port);
    const tcp::socket second = connect(outside, port);
    while (accepted < 2) {
        context.run_one();
    }
    REQUIRE(log.lines.size() == 2);
    CHECK(log.lines[1] == "handler of a new connection threw: no memory");
    listener->close();
}

TEST_CASE("a handler of SIGHUP that throws does not keep the next from it", "[net]")
{
    Narrow narrow;
    std::atomic<int> calls{0};
    narrow.loop.on_hangup([&] {
        ++calls;
        throw std::runtime_error{"no file"};
    });
    narrow.run();
    for (int i = 1; i <= 2; ++i) {
        REQUIRE(std::raise(SIGHUP) == 0);
        while (calls < i) {
            std::this_thread::yield();
        }
    }
    CHECK(calls == 2);
}

TEST_CASE("SIGHUP calls the handler each time", "[net]")
{
    Narrow narrow;
    std::atomic<int> calls{0};
    narrow.loop.on_hangup([&] { ++calls; });
    narrow.run();
    for (int i = 1; i <= 2; ++i) {
        REQUIRE(std::raise(SIGHUP) == 0);
        while (calls < i) {
            std::this_thread::yield();
        }
    }
    CHECK(calls == 2);
}

TEST_CASE("a port that is reserved refuses peers until it listens", "[net]")
{
    net::StderrLog log{LogLevel::Error};
    net::ServerLoop loop{log};
    const auto port = loop.reserve("127.0.0.1", 0);
    REQUIRE(port);
    const auto connects = [&] {
        asio::io_context context;
        tcp::socket peer{context};
        std::error_code error;
        peer.connect({asio::ip::make_address("127.0.0.1"), *port}, error);
        return error;
    };
    CHECK(connects() == asio::error::connection_refused);
    REQUIRE(loop.listen_on_reserved());
    CHECK_FALSE(connects());
    // It stays as it is, and nobody else gets the port.
    CHECK(loop.listen_on_reserved());
    NullLog silence;
    net::ServerLoop other{silence};
    CHECK_FALSE(other.reserve("127.0.0.1", *port));
    CHECK_FALSE(other.listen("127.0.0.1", *port));
}

TEST_CASE("of two programs that have reserved one port the first that listens gets it", "[net]")
{
    NullLog silence;
    net::ServerLoop first{silence};
    net::ServerLoop second{silence};
    const auto port = first.reserve("127.0.0.1", 0);
    REQUIRE(port);
    if (!second.reserve("127.0.0.1", *port)) {
        return; // a system that tells apart at once
    }
    CHECK(first.listen_on_reserved());
    CHECK_FALSE(second.listen_on_reserved());
}

} // namespace listener_test
