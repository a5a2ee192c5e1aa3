#include <catch2/catch.hpp>

#include <future>
#include <optional>
#include <thread>
#include <vector>

#include <asio/bind_cancellation_slot.hpp>
#include <asio/cancellation_signal.hpp>
#include <asio/executor_work_guard.hpp>
#include <asio/experimental/deferred.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_future.hpp>
#ifdef ASIO_HAS_CO_AWAIT
#include <asio/co_spawn.hpp>
#include <asio/experimental/awaitable_operators.hpp>
#include <asio/use_awaitable.hpp>
#endif

#include <busbar/net/async_client.hpp>

#include "machine.hpp"

namespace async_client_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::Machine;
using client::ClientState;

namespace {

/// An AsyncClient that somebody runs.
struct Async : test::ClientSurroundings {
    explicit Async(const std::string& url)
        : client{std::make_unique<net::AsyncClient>(context.get_executor(),
                                                    test::client_config(url), environment)}
    {
    }

    asio::io_context context;
    std::unique_ptr<net::AsyncClient> client;
};

/// A client of somebody who takes connections and says nothing.
struct Unanswered {
    asio::io_context context;
    asio::ip::tcp::acceptor acceptor{context, {asio::ip::make_address("127.0.0.1"), 0}};
    Async user{"opc.tcp://127.0.0.1:" + std::to_string(acceptor.local_endpoint().port())};

    std::optional<StatusCode> connected;
    std::optional<StatusCode> read;

    void begin(Duration timeout, const client::RequestOptions& options = {})
    {
        user.client->connect(timeout, [this](const Result<void>& result) {
            connected = result ? StatusCode{} : result.error();
        });
        user.client->call<ReadResponse>(
            test::read_request(test::state_node),
            [this](const Result<ReadResponse>& result) {
                read = result ? StatusCode{} : result.error();
            },
            options);
    }
    void run_until_over()
    {
        while (!connected || !read) {
            REQUIRE(user.context.run_one() != 0);
        }
    }
};

} // namespace

TEST_CASE("callbacks come later, one for each call", "[net][client]")
{
    Machine machine;
    Async user{machine.url()};
    int answers = 0;
    bool is_closed = false;
    user.client->connect(10s, [&](const Result<void>& connected) {
        REQUIRE(connected);
        for (int i = 0; i < 20; ++i) {
            user.client->call<ReadResponse>(test::read_request(test::state_node),
                                            [&](const Result<ReadResponse>& response) {
                                                REQUIRE(response);
                                                if (++answers == 20) {
                                                    user.client->close([&] { is_closed = true; });
                                                }
                                            });
        }
        CHECK(answers == 0);
    });
    CHECK(user.client->client().state() == ClientState::Waiting);
    user.context.run(); // until there is nothing left to do
    CHECK(answers == 20);
    CHECK(is_closed);
    CHECK(user.client->client().state() == ClientState::Closed);
}

TEST_CASE("another thread waits for futures", "[net][client]")
{
    Machine machine;
    Async user{machine.url()};
    auto work = asio::make_work_guard(user.context);
    std::thread thread{[&] { user.context.run(); }};
    const auto connected = user.client->connect(10s, asio::use_future).get();
    auto first =
        user.client->call<ReadResponse>(test::read_request(test::state_node), asio::use_future);
    auto deferred = user.client->call<WriteResponse>(
        test::write_request(machine.node("Level"), Variant{0.5}), asio::experimental::deferred);
    const auto written = std::move(deferred)(asio::use_future).get();
    const auto read = first.get();
    user.client->close(asio::use_future).get();
    work.reset();
    thread.join();
    CHECK(connected);
    REQUIRE(read);
    CHECK(read->results[0].value == Variant{std::int32_t{0}});
    REQUIRE(written);
    CHECK(written->results[0] == StatusCode{});
}

TEST_CASE("connections and requests have their time", "[net][client]")
{
    Unanswered peer;
    client::RequestOptions options;
    options.timeout = 20ms;
    peer.begin(30ms, options);
    peer.run_until_over();
    CHECK(*peer.connected == status::Bad_Timeout);
    CHECK(*peer.read == status::Bad_Timeout);
    bool is_closed = false;
    peer.user.client->close([&] { is_closed = true; });
    peer.user.context.run();
    CHECK(is_closed);
}

TEST_CASE("operations are cancelled one by one", "[net][client]")
{
    Unanswered peer;
    asio::cancellation_signal signal;
    std::vector<StatusCode> ends;
    for (int i = 0; i < 2; ++i) {
        auto handler = [&ends](const Result<ReadResponse>& result) {
            ends.push_back(result ? StatusCode{} : result.error());
        };
        if (i == 0) {
            peer.user.client->call<ReadResponse>(
                test::read_request(test::state_node),
                asio::bind_cancellation_slot(signal.slot(), handler));
        } else {
            peer.user.client->call<ReadResponse>(test::read_request(test::state_node), handler);
        }
    }
    peer.begin(1h);
    asio::post(peer.user.context, [&] {
        signal.emit(asio::cancellation_type::terminal);
        signal.emit(asio::cancellation_type::terminal); // no more than once
        CHECK(ends.empty());
    });
    while (ends.empty()) {
        REQUIRE(peer.user.context.run_one() != 0);
    }
    CHECK(ends == std::vector<StatusCode>{status::Bad_RequestCancelledByClient});
    CHECK_FALSE(peer.read);
}

TEST_CASE("nothing is left when the client goes", "[net][client]")
{
    Unanswered peer;
    peer.begin(1h);
    SECTION("before anything happened") {}
    SECTION("while it connects")
    {
        peer.user.context.run_one();
    }
    SECTION("while it is connected")
    {
        while (peer.user.client->client().state() != ClientState::Discovering) {
            REQUIRE(peer.user.context.run_one() != 0);
        }
    }
    peer.user.client.reset();
    CHECK_FALSE(peer.connected);
    peer.user.context.restart();
    peer.user.context.run(); // and there is nothing left to do after that
    REQUIRE(peer.connected);
    CHECK(*peer.connected == status::Bad_ConnectionClosed);
    REQUIRE(peer.read);
    CHECK(*peer.read == status::Bad_ConnectionClosed);
}

TEST_CASE("a handler of the Client may destroy it all", "[net][client]")
{
    Machine machine;
    Async user{machine.url()};
    const auto when = GENERATE(ClientState::Connecting, ClientState::Discovering,
                               ClientState::Opening, ClientState::Ready);
    std::optional<StatusCode> connected;
    user.client->client().on_state([&](ClientState state, StatusCode) {
        if (state == when) {
            user.client.reset();
        }
    });
    user.client->connect(10s, [&](const Result<void>& result) {
        connected = result ? StatusCode{} : result.error();
    });
    user.context.run();
    CHECK_FALSE(user.client);
    REQUIRE(connected);
    CHECK(*connected == status::Bad_ConnectionClosed);
}

TEST_CASE("what a completion handler throws comes out of run()", "[net][client]")
{
    Machine machine;
    Async user{machine.url()};
    user.client->connect(10s, [](const Result<void>&) { throw 7; });
    CHECK_THROWS_AS(user.context.run(), int);
    bool is_closed = false;
    user.client->close([&] { is_closed = true; });
    user.context.run();
    CHECK(is_closed);
}

#ifdef ASIO_HAS_CO_AWAIT
namespace {

asio::awaitable<Variant> read_level(net::AsyncClient& client, NodeId level)
{
    const Result<void> connected = co_await client.connect(10s, asio::use_awaitable);
    CHECK(connected);
    const Result<WriteResponse> written = co_await client.call<WriteResponse>(
        test::write_request(level, Variant{4.5}), asio::use_awaitable);
    CHECK(written);
    const Result<ReadResponse> read =
        co_await client.call<ReadResponse>(test::read_request(level), asio::use_awaitable);
    CHECK(read);
    co_await client.close(asio::use_awaitable);
    co_return read ? read->results[0].value : Variant{};
}

asio::awaitable<std::size_t> first_of_two(net::AsyncClient& client)
{
    using namespace asio::experimental::awaitable_operators;
    asio::steady_timer timer{co_await asio::this_coro::executor, 1ms};
    const auto first = co_await (
        client.call<ReadResponse>(test::read_request(test::state_node), asio::use_awaitable) ||
        timer.async_wait(asio::use_awaitable));
    co_return first.index();
}

} // namespace

TEST_CASE("a coroutine awaits one thing after the other", "[net][client]")
{
    Machine machine;
    Async user{machine.url()};
    auto value = asio::co_spawn(user.context, read_level(*user.client, machine.node("Level")),
                                asio::use_future);
    user.context.run();
    CHECK(value.get() == Variant{4.5});
}

TEST_CASE("a coroutine that lost interest cancels", "[net][client]")
{
    Unanswered peer;
    auto first =
        asio::co_spawn(peer.user.context, first_of_two(*peer.user.client), asio::use_future);
    peer.user.context.run(); // ends, because the call has ended too
    CHECK(first.get() == 1);
}
#endif

} // namespace async_client_test
