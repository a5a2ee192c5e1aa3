#pragma once

#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/write.hpp>

#include <busbar/client/connection.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/ids.hpp>

#include "machine.hpp"

namespace busbar::test {

/// A server whose loop is in the test's hands, with a Variable that is too long for any socket.
class Station {
public:
    static constexpr std::size_t text_size = 256U << 10U;

    Station() { users_.set_anonymous_access(0xFF); }
    Station(const Station&) = delete;
    Station& operator=(const Station&) = delete;
    ~Station() { stop(); }

    /// With `config` as it is then.
    void run()
    {
        make();
        thread_ = std::thread{[this] { loop.run(*server_); }};
    }
    void make()
    {
        server_.emplace(*server::Server::create(config, {.random = &random_,
                                                         .wall_clock = &clock_,
                                                         .log = &log,
                                                         .users = &users_,
                                                         .waker = &loop.waker()}));
        server_->add_source(memory_);
        model::AddressSpace& space = server_->address_space();
        REQUIRE(space.add_variable(space.find(id::ObjectsFolder), {1, "Text"},
                                   memory_.variable(String{std::string(text_size, 'x')})));
    }
    /// Ends when run() does.
    void join()
    {
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    void stop()
    {
        loop.stop();
        join();
    }
    /// What `work` gives on the loop's thread.
    template <typename Work>
    auto ask(Work work)
    {
        std::promise<decltype(work())> answer;
        loop.post([&] { answer.set_value(work()); });
        return answer.get_future().get();
    }
    /// Until the server has so many.
    void await_connections(std::size_t count)
    {
        while (ask([this] { return server_->connection_count(); }) != count) {
            std::this_thread::yield();
        }
    }
    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port); }
    [[nodiscard]] server::Server& server() { return *server_; }

    harness::LogBook log;
    net::ServerLoop loop{log};
    const std::uint16_t port{*loop.listen("127.0.0.1", 0)};
    server::ServerConfig config{server_config(port)};

private:
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    server::PasswordUsers users_;
    server::MemorySource memory_{clock_};
    std::optional<server::Server> server_;
    std::thread thread_;
};

inline const NodeId text_node{1, "Text"};

/// A client whose socket is in the test's hands.
class BareClient : public ClientSurroundings {
public:
    /// A small buffer has the server wait soon for what is not read.
    explicit BareClient(std::uint16_t port, int receive_buffer = 0)
    {
        socket.open(asio::ip::tcp::v4());
        if (receive_buffer != 0) {
            socket.set_option(asio::socket_base::receive_buffer_size{receive_buffer});
        }
        socket.connect({asio::ip::address_v4::loopback(), port});
        client::ConnectionConfig config;
        config.channel.endpoint_url = "opc.tcp://127.0.0.1:" + std::to_string(port);
        connection_.emplace(std::move(config), environment, now());
    }
    /// Until the session is there.
    void open() { REQUIRE(await().kind == client::ConnectionEvent::Kind::Ready); }
    void ask(const NodeId& node, int times = 1)
    {
        for (int i = 0; i < times; ++i) {
            REQUIRE(connection_->send(read_request(node)));
        }
        flush();
    }
    [[nodiscard]] client::ConnectionEvent await()
    {
        for (;;) {
            if (auto event = connection_->next_event()) {
                return *std::move(event);
            }
            flush();
            receive();
        }
    }
    [[nodiscard]] Variant answer()
    {
        const auto event = await();
        const auto response = event.response<ReadResponse>();
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        return response->results[0].value;
    }
    /// Goes without a word: what comes then is answered with a reset.
    void reset()
    {
        socket.set_option(asio::socket_base::linger{true, 0});
        socket.close();
    }
    /// What is read at the end of the connection.
    [[nodiscard]] std::error_code end()
    {
        std::error_code error;
        while (!error) {
            socket.read_some(asio::buffer(buffer_), error);
        }
        return error;
    }

    asio::io_context context;
    asio::ip::tcp::socket socket{context};

private:
    [[nodiscard]] static TimePoint now()
    {
        return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
    }
    void flush()
    {
        const auto output = connection_->output();
        asio::write(socket, asio::buffer(output.data(), output.size()));
        connection_->consume(output.size());
    }
    void receive()
    {
        const std::size_t size = socket.read_some(asio::buffer(buffer_));
        REQUIRE(connection_->feed(std::span{buffer_}.first(size), now()));
    }

    std::optional<client::Connection> connection_;
    std::array<std::byte, 65'536> buffer_{};
};

} // namespace busbar::test
