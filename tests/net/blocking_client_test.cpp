#include <catch2/catch.hpp>

#include <csignal>
#include <future>
#include <stdexcept>
#include <thread>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <busbar/harness/log_book.hpp>
#include <busbar/net/blocking_client.hpp>

#include "machine.hpp"
#include "net/client_driver.hpp"
#include "support/identity.hpp"

namespace blocking_client_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::Machine;
using client::ClientState;

namespace {

struct Blocking : test::ClientSurroundings {
    explicit Blocking(client::ClientConfig config) : client{std::move(config), environment} {}

    [[nodiscard]] Variant read(const NodeId& node)
    {
        const auto response = client.call<ReadResponse>(test::read_request(node));
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        return response->results[0].value;
    }

    net::BlockingClient client;
};

/// Somebody who takes connections and says nothing.
struct SilentPort {
    asio::io_context context;
    asio::ip::tcp::acceptor acceptor{context, {asio::ip::make_address("127.0.0.1"), 0}};

    [[nodiscard]] std::string url() const
    {
        return "opc.tcp://127.0.0.1:" + std::to_string(acceptor.local_endpoint().port());
    }
};

net::BlockingClient* signalled = nullptr;

} // namespace

TEST_CASE("a blocking client reads and writes", "[net][client][unit:Attribute Client Read Base]"
                                                "[unit:Attribute Client Write Base]")
{
    Machine machine;
    Blocking user{test::client_config(machine.url())};
    REQUIRE(user.client.connect());
    CHECK(user.client.client().state() == ClientState::Ready);
    const auto written =
        user.client.call<WriteResponse>(test::write_request(machine.node("Level"), Variant{2.5}));
    REQUIRE(written);
    CHECK(written->results[0] == StatusCode{});
    CHECK(user.read(machine.node("Level")) == Variant{2.5});
    user.client.close();
    CHECK(user.client.client().state() == ClientState::Closed);
    // And once more.
    REQUIRE(user.client.connect());
    CHECK(user.read(machine.node("Level")) == Variant{2.5});
}

namespace {

/// Counts how often it is copied.
struct CountedRead : ReadRequest {
    explicit CountedRead(ReadRequest request) : ReadRequest{std::move(request)} {}
    CountedRead(const CountedRead& other) : ReadRequest{other} { ++copies; }
    CountedRead(CountedRead&&) = default;
    CountedRead& operator=(const CountedRead&) = delete;
    CountedRead& operator=(CountedRead&&) = delete;
    ~CountedRead() = default;

    static inline int copies{0};
};

} // namespace

TEST_CASE("a request of a blocking client is sent from where it is", "[net][client]")
{
    Machine machine;
    Blocking user{test::client_config(machine.url())};
    REQUIRE(user.client.connect());
    CountedRead::copies = 0;
    CountedRead request{test::read_request(machine.node("Level"))};
    const ReadRequest before = request;
    const auto response = user.client.call<ReadResponse>(request);
    REQUIRE(response);
    CHECK(response->results.size() == 1);
    CHECK(request == before); // with the header that it had
    CHECK(user.client.call<ReadResponse>(CountedRead{before}));
    CHECK(CountedRead::copies == 0);
    const CountedRead fixed{before};
    CHECK(user.client.call<ReadResponse>(fixed));
    CHECK(CountedRead::copies != 0);
}

TEST_CASE("several addresses are tried, one after the other", "[net][client]")
{
    Machine machine; // listens on 127.0.0.1 only; localhost may be ::1 first
    Blocking user{test::client_config("opc.tcp://localhost:" + std::to_string(machine.port()))};
    REQUIRE(user.client.connect());
}

TEST_CASE("a client is told that nobody is there, unless it may try again", "[net][client]")
{
    auto config = test::client_config("opc.tcp://127.0.0.1:1");
    SECTION("it may not")
    {
        config.reconnect.is_enabled = false;
        Blocking user{config};
        const auto connected = user.client.connect();
        REQUIRE_FALSE(connected);
        CHECK(connected.error() == status::Bad_CommunicationError);
    }
    SECTION("it may")
    {
        Blocking user{config};
        const auto connected = user.client.connect(100ms);
        REQUIRE_FALSE(connected);
        CHECK(connected.error() == status::Bad_Timeout);
        CHECK(user.client.client().last_error() == status::Bad_CommunicationError);
    }
    SECTION("the URL is none")
    {
        config.endpoint_url = "http://127.0.0.1";
        config.reconnect.is_enabled = false;
        Blocking user{config};
        const auto connected = user.client.connect();
        REQUIRE_FALSE(connected);
        CHECK(connected.error() == status::Bad_TcpEndpointUrlInvalid);
    }
}

TEST_CASE("the log of a client says why there is no connection", "[net][client]")
{
    harness::LogBook log;
    test::ClientSurroundings surroundings;
    surroundings.environment.log = &log;
    net::BlockingClient client{test::client_config("opc.tcp://127.0.0.1:1"),
                               surroundings.environment};
    REQUIRE_FALSE(client.connect(100ms));
    CHECK(log.contains(
        "no connection: Connection refused (Bad_CommunicationError); next attempt in "));
}

TEST_CASE("a server that says nothing holds nobody up", "[net][client]")
{
    SilentPort silent;
    Blocking user{test::client_config(silent.url())};
    const auto connected = user.client.connect(50ms);
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_Timeout);
    client::RequestOptions options;
    options.timeout = 20ms;
    const auto read = user.client.call<ReadResponse>(test::read_request(test::state_node), options);
    REQUIRE_FALSE(read);
    CHECK(read.error() == status::Bad_Timeout);
    options.waits_for_session = false;
    const auto hasty =
        user.client.call<ReadResponse>(test::read_request(test::state_node), options);
    REQUIRE_FALSE(hasty);
    CHECK(hasty.error() == status::Bad_ServerNotConnected);
    user.client.close();
}

TEST_CASE("localhost needs neither a name server nor a file of hosts", "[net][client]")
{
    using net::detail::loopback_addresses;
    for (const char* name : {"localhost", "LocalHost", "localhost."}) {
        const auto addresses = loopback_addresses(name);
        REQUIRE(addresses.size() == 2);
        CHECK(addresses[0].to_string() == "127.0.0.1");
        CHECK(addresses[1].to_string() == "::1");
    }
    for (const char* name : {"", ".", "localhost.example", "plant"}) {
        CHECK(loopback_addresses(name).empty());
    }
}

TEST_CASE("a name server that says nothing holds nobody up", "[net][client]")
{
    test::ClientSurroundings around;
    std::promise<void> go_on;
    const auto over = std::make_shared<std::promise<void>>(); // the thread's, too
    {
        asio::io_context context;
        auto config = test::client_config("opc.tcp://plc.example:4840");
        config.connect_timeout = 50ms;
        config.reconnect.is_enabled = false;
        const auto driver = std::make_shared<net::detail::ClientDriver>(
            context.get_executor(), config, around.environment,
            [over, wait = go_on.get_future().share()](const std::string& host) {
                wait.wait();
                CHECK(host == "plc.example");
                over->set_value();
                return std::vector<asio::ip::address>{};
            });
        driver->client().connect(net::detail::now());
        driver->step();
        while (driver->client().state() != ClientState::Closed) {
            REQUIRE(context.run_one() != 0);
        }
        CHECK(driver->client().last_error() == status::Bad_Timeout);
        driver->stop();
    }
    go_on.set_value(); // everything else is gone
    over->get_future().wait();
}

TEST_CASE("a running client finds a server that was started again", "[net][client]")
{
    auto machine = std::make_unique<Machine>();
    const std::uint16_t port = machine->port();
    Blocking user{test::client_config(machine->url())};
    REQUIRE(user.client.connect());
    machine.reset();
    REQUIRE(
        user.client.run_until([&] { return user.client.client().state() != ClientState::Ready; }));
    machine = std::make_unique<Machine>(port);
    // Waits for the new session.
    CHECK(user.read(test::state_node) == Variant{std::int32_t{0}});
}

TEST_CASE("whoever waits can be interrupted", "[net][client]")
{
    SilentPort silent;
    Blocking user{test::client_config(silent.url())};
    const auto never = [] { return false; };
    SECTION("before it waits")
    {
        user.client.interrupt();
        CHECK_FALSE(user.client.run_until(never));
        CHECK(user.client.run_for(1ms)); // once only
    }
    SECTION("by another thread")
    {
        std::thread other{[&] { user.client.interrupt(); }};
        const auto connected = user.client.connect(1h);
        other.join();
        REQUIRE_FALSE(connected);
        CHECK(connected.error() == status::Bad_RequestInterrupted);
    }
    SECTION("by a signal")
    {
        signalled = &user.client;
        const auto before = std::signal(SIGUSR1, [](int) { signalled->interrupt(); });
        REQUIRE(std::raise(SIGUSR1) == 0);
        const auto read = user.client.call<ReadResponse>(test::read_request(test::state_node));
        std::signal(SIGUSR1, before);
        REQUIRE_FALSE(read);
        CHECK(read.error() == status::Bad_RequestInterrupted);
    }
    SECTION("and has a time")
    {
        CHECK_FALSE(user.client.run_until(never, 1ms));
        CHECK(user.client.run_for(0ms));
    }
}

TEST_CASE("what a handler throws is logged, and the client goes on", "[net][client]")
{
    Machine machine;
    test::ClientSurroundings around;
    test::LogBook log;
    around.environment.log = &log;
    net::BlockingClient client{test::client_config(machine.url()), around.environment};
    int changes = 0;
    client.client().on_state([&](ClientState, StatusCode) {
        if (++changes == 1) {
            throw std::runtime_error{"a mistake of the user"};
        }
        if (changes == 2) {
            throw 7;
        }
    });
    REQUIRE(client.connect());
    CHECK(changes > 2);
    CHECK(log.text.find("a mistake of the user") != std::string::npos);
    CHECK(log.text.find("unknown exception") != std::string::npos);
}

TEST_CASE("a handler cannot wait for what only comes after it", "[net][client]")
{
    Machine machine;
    Blocking user{test::client_config(machine.url())};
    std::optional<StatusCode> nested;
    user.client.client().on_state([&](ClientState state, StatusCode) {
        if (state == ClientState::Ready) {
            const auto read = user.client.call<ReadResponse>(test::read_request(test::state_node));
            nested = read ? StatusCode{} : read.error();
        }
    });
    REQUIRE(user.client.connect());
    REQUIRE(user.client.run_until([&] { return nested.has_value(); }));
    CHECK(*nested == status::Bad_RequestInterrupted);
    CHECK(user.read(test::state_node) == Variant{std::int32_t{0}});
}

TEST_CASE("a blocking client looks up when something can be read, once in each call",
          "[net][client]")
{
    Machine machine;
    Blocking user{test::client_config(machine.url())};
    REQUIRE(user.client.connect());
    int pipe[2];
    REQUIRE(::pipe(pipe) == 0);
    REQUIRE(user.client.wake_on(pipe[0]));
    const auto is_readable = [&] {
        ::pollfd input{pipe[0], POLLIN, 0};
        return ::poll(&input, 1, 0) > 0;
    };
    ssize_t written = 0;
    std::thread writer{[&] { written = ::write(pipe[1], "x", 1); }};
    CHECK(user.client.run_until(is_readable, 30s));
    writer.join();
    CHECK(written == 1);
    // What is not read keeps nobody from working, nor does it spin.
    std::size_t looks = 0;
    CHECK_FALSE(user.client.run_until([&] { return ++looks > 1'000; }, 100ms));
    CHECK(user.read(machine.node("Level")).type() == BuiltInType::Double);
    CHECK((::fcntl(pipe[0], F_GETFL) & O_NONBLOCK) == 0);
    ::close(pipe[0]);
    ::close(pipe[1]);
    const int file = ::open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    CHECK(user.client.wake_on(file).error() == status::Bad_CommunicationError);
    ::close(file);
    CHECK(user.client.run_for(1ms));
}

} // namespace blocking_client_test
