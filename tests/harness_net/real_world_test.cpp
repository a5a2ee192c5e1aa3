#include <catch2/catch.hpp>

#include <atomic>
#include <thread>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/harness_net/real_world.hpp>
#include <busbar/net/blocking_client.hpp>

#include "net/machine.hpp"
#include "support/identity.hpp"

namespace real_world_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

/// A real client on a thread of its own, which does one thing.
class RealClient : test::ClientSurroundings {
public:
    template <typename Work>
    RealClient(const std::string& url, Work work)
        : thread_{[this, url, work] {
              net::BlockingClient client{test::client_config(url), environment};
              work(client);
              is_done = true;
          }}
    {
    }
    ~RealClient() { thread_.join(); }

    std::atomic<bool> is_done{false};

private:
    std::thread thread_;
};

/// A source whose bus answers on a thread, after a while.
class SlowSource final : public server::DataSource {
public:
    ~SlowSource() override
    {
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    void read(server::ReadBatch batch) override
    {
        if (thread_.joinable()) {
            thread_.join();
        }
        thread_ = std::thread{[kept = std::make_shared<server::ReadBatch>(std::move(batch))] {
            std::this_thread::sleep_for(5ms);
            for (server::ReadSlot& slot : kept->results()) {
                slot = DataValue{Variant{7.5}};
            }
            kept->complete();
        }};
    }

private:
    std::thread thread_;
};

} // namespace

TEST_CASE("a real client meets a server in a world, and its faults", "[harness]")
{
    RealWorld world;
    const auto recorder = std::make_shared<Recorder>(world.seed());
    world.network().set_observer(recorder);
    BenchOptions options;
    options.server.endpoint_url = need(world.open("127.0.0.1"));
    Bench bench{world, std::move(options)};
    const NodeId level = need(bench.add_variable("Level", 1.5));
    world.network().play(fault::answer(status::Bad_Timeout).at(Message{"ReadRequest", 3}));

    std::vector<Result<ReadResponse>> answers;
    {
        const RealClient client{
            bench.server().config().endpoint_url, [&](net::BlockingClient& real) {
                if (real.connect()) {
                    for (int i = 0; i < 3; ++i) {
                        answers.push_back(real.call<ReadResponse>(test::read_request(level)));
                    }
                }
                real.close();
            }};
        REQUIRE(world.run_until([&] { return client.is_done.load(); }, 20s));
    }
    REQUIRE(answers.size() == 3);
    REQUIRE(answers[0]);
    CHECK(answers[0]->results[0].value == Variant{1.5});
    CHECK(answers[1].error() == status::Bad_Timeout);
    REQUIRE(answers[2]);
    CHECK_THAT(world.trace(), Catch::Contains("client -> ReadRequest ns=1;s=Level") &&
                                  Catch::Contains("network: answer Bad_Timeout at ReadRequest 3"));
    CHECK_FALSE(recorder->recording().entries.empty());
    CHECK(world.run_until([&] { return world.socket_count() == 0; }, 20s));
}

TEST_CASE("a client in a world reaches a real server", "[harness]")
{
    test::Machine machine;
    RealWorld world;
    REQUIRE(world.reach(machine.url()));
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = machine.url();
    ConnectionHost client{world, config};
    CHECK_THAT(client.open(20s), succeeds<void>());
    const auto response = client.call<ReadResponse>(test::read_request(machine.node("Level")), 20s);
    CHECK_THAT(response, succeeds<ReadResponse>());
    world.network().cut();
    CHECK(world.run_until([&] { return !client.is_ready(); }, 20s));
    // Two of one address, and none.
    CHECK(world.reach(machine.url()).error() == status::Bad_InvalidState);
    CHECK(world.reach("no URL").error() == status::Bad_TcpEndpointUrlInvalid);
}

TEST_CASE("a server that is not there is no connection", "[harness]")
{
    RealWorld world;
    // The port of a socket that is closed again.
    std::string url;
    {
        RealWorld other;
        url = need(other.open("127.0.0.1"));
    }
    REQUIRE(world.reach(url));
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = url;
    ConnectionHost client{world, config};
    CHECK(client.open(20s).error() == status::Bad_ConnectionClosed);
    CHECK(world.log().contains("sockets: cannot connect to 127.0.0.1:"));
}

TEST_CASE("a world between two real peers sees and changes what they say", "[harness]")
{
    test::Machine machine;
    RealWorld world;
    const std::string url = need(world.open("127.0.0.1"));
    REQUIRE(world.forward(url, machine.url()));
    world.network().play(
        fault::edit("results[0].value", "Double:7.5").at(Message{"ReadResponse"}).times(0));
    Result<ReadResponse> answer;
    {
        const RealClient client{url, [&](net::BlockingClient& real) {
                                    if (real.connect()) {
                                        answer = real.call<ReadResponse>(
                                            test::read_request(machine.node("Level")));
                                    }
                                    real.close();
                                }};
        REQUIRE(world.run_until([&] { return client.is_done.load(); }, 20s));
    }
    REQUIRE(answer);
    CHECK(answer->results[0].value == Variant{7.5});
    CHECK_THAT(world.trace(), Catch::Contains("client -> ReadRequest"));
}

TEST_CASE("a bench in real time waits for threads", "[harness]")
{
    RealWorld world;
    Bench bench{world};
    auto& source = bench.make_source<SlowSource>();
    const NodeId level = need(bench.add_variable("Level", source.variable(0, 0.0)));
    CHECK_THAT(bench.read(level), holds(7.5));
    REQUIRE(bench.subscribe(level, 50ms) == status::Good);
    REQUIRE(world.run_until([&] { return !bench.values(level).empty(); }, 20s));
}

TEST_CASE("who connects where nobody listens in the world is turned away", "[harness]")
{
    RealWorld world;
    const std::string url = need(world.open("127.0.0.1"));
    std::atomic<bool> is_closed{false};
    std::thread stranger{[&] {
        asio::io_context context;
        asio::ip::tcp::socket socket{context};
        asio::error_code error;
        const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
        socket.connect({asio::ip::make_address("127.0.0.1"), port}, error);
        std::array<char, 1> byte{};
        asio::read(socket, asio::buffer(byte), error);
        is_closed = static_cast<bool>(error);
    }};
    CHECK(world.run_until([&] { return is_closed.load(); }, 20s));
    stranger.join();
    CHECK(world.log().contains("there is no listener at opc.tcp://127.0.0.1:"));
    CHECK(world.open("no address").error() == status::Bad_CommunicationError);
}

} // namespace real_world_test
